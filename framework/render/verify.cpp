#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/image/metrics.h>
#include <weir/render/lanes.h>
#include <weir/render/reference_picture.h>
#include <weir/render/render.h>
#include <weir/render/verify.h>
#include <weir/render/write_file.h>

#include <bit>
#include <charconv>
#include <chrono>
#include <filesystem>

namespace weir::render {
namespace {

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr uint32_t kCoarse = 4;  ///< fine tiles along the side of a coarse one

void checkOptions(const VerifyOptions& o) {
  requireSize(o.width, o.height);
  if (o.frames == 0) throw InputError("--frames must be at least 1");
  requireFrameNumbers(o.firstFrame, "--frames", o.frames);
  if (o.restarts < 2) throw InputError(fmt::format("--restarts {}: must be at least 2", o.restarts));
  if (o.mostRestarts != 0 && o.mostRestarts < o.restarts)
    throw InputError(fmt::format("--max-restarts {}: must be at least --restarts {}", o.mostRestarts, o.restarts));
  parseLanes(o.lanes);
  if (o.tile == 0 || o.tile > 4096) throw InputError(fmt::format("--tile {}: must be 1 … 4096", o.tile));
  const image::VerdictOptions& v = o.verdict;
  if (!(v.alpha > 0.0 && v.alpha <= 0.5))
    throw InputError(fmt::format("--alpha {}: must be above 0, at most 0.5", v.alpha));
  if (!(v.tolerance > 0.0 && v.tolerance <= 1.0))
    throw InputError(
        fmt::format("--tolerance {}: must be above 0, at most 1 (relative: 0.005 is half a percent)", v.tolerance));
  if (!(v.tileTolerance > 0.0 && v.tileTolerance <= 100.0))
    throw InputError(fmt::format("--tile-tolerance {}: must be above 0, at most 100 (relative: 0.05 is five percent)",
                                 v.tileTolerance));
  if (!(v.negligible >= 0.0 && v.negligible <= 0.1))
    throw InputError(fmt::format("--negligible {}: must be 0 … 0.1", v.negligible));
  if (o.reference.empty()) {
    if (!o.referenceError.empty()) throw InputError("--reference-stderr needs --reference");
    if (o.referenceExact) throw InputError("--reference-exact needs --reference");
    if (o.referenceRestarts == 1) throw InputError("--reference-restarts 1: must be at least 2");
    if (o.referenceFrames == 0) throw InputError("--reference-frames must be at least 1");
    if (!o.stage.animate) requireFrameNumbers(o.firstFrame, "--reference-frames", o.referenceFrames);
  } else {
    if (!o.referenceGraph.empty()) throw InputError("--reference and --reference-graph: only one of them");
    if (!o.referenceOverrides.set.empty()) throw InputError("--reference-set needs a reference that is rendered here");
    if (o.referenceExact && !o.referenceError.empty())
      throw InputError("--reference-exact and --reference-stderr: only one of them");
  }
  if (!o.picture.empty()) {
    const std::string extension = std::filesystem::path(o.picture).extension().string();
    if (extension != ".png" && extension != ".exr")
      throw InputError(fmt::format("--out {}: the file must end in .png (a map) or .exr (differences)", o.picture));
    checkWritable(o.picture);
  }
  if (!o.json.empty()) checkWritable(o.json);
  requireDistinct({{"--out", o.picture}, {"--json", o.json}}, {{"the graph", o.graph},
                                                               {"--scene", o.stage.scene},
                                                               {"--environment", o.stage.environment},
                                                               {"--reference", o.reference},
                                                               {"--reference-stderr", o.referenceError},
                                                               {"--reference-graph", o.referenceGraph}});
}

uint64_t restartsOf(const image::Picture& picture) {
  const auto found = picture.attributes.find("weir.restarts");
  uint64_t count = 0;
  if (found != picture.attributes.end())
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), count);
  return count;
}

/// Number of the frame that a clip is compared at.
uint64_t lastFrame(const VerifyOptions& o) {
  return uint64_t{o.firstFrame} + o.frames - 1;
}

std::string animationOf(const VerifyOptions& o, const Stage& stage) {
  const std::string label = animationLabel(stage, lastFrame(o), lastFrame(o));
  return label.empty() ? "none" : label;
}

struct FileReference {
  image::Picture picture, error;
  ReferenceKind kind = ReferenceKind::Exact;
};

/// The pass that moved all pixels of a frame by one offset, if the header tells of one. Numbers of pixels that moved
/// together are no independent samples, which is what the error of a picture from a file is made of.
std::string jitteringPass(const image::Picture& picture) {
  const auto found = picture.attributes.find("weir.params");
  if (found == picture.attributes.end()) return "";
  constexpr std::string_view kSet = ".jitter=true ";  // every parameter ends in a space
  const std::string& params = found->second;
  const size_t at = params.find(kSet);
  if (at == std::string::npos) return "";
  const size_t before = params.rfind(' ', at);
  const size_t start = before == std::string::npos ? 0 : before + 1;
  return params.substr(start, at - start);
}

void requireStillPixels(const std::string& file, const image::Picture& picture) {
  const std::string pass = jitteringPass(picture);
  if (pass.empty()) return;
  throw InputError(
      fmt::format("'{}' was rendered with {}.jitter=true: all pixels of a frame share its offset, so that their errors "
                  "add up and can't be told from the file. Leave --reference out and have the reference rendered here, "
                  "with --reference-set {}.jitter=true, where whole restarts are the samples",
                  file, pass, pass));
}

FileReference readReference(const VerifyOptions& o) {
  FileReference r;
  r.picture = readRadiance(o.reference, o.width, o.height);
  if (!o.referenceExact) requireStillPixels(o.reference, r.picture);
  if (!o.referenceError.empty()) {
    r.error = readRadiance(o.referenceError, o.width, o.height);
    requireStillPixels(o.referenceError, r.error);
    const auto conflicts = image::attributeConflicts(r.error, r.picture);
    if (!conflicts.empty())
      throw InputError(fmt::format("'{}' is no standard error of '{}':\n  {}", o.referenceError, o.reference,
                                   fmt::join(conflicts, "\n  ")));
    r.kind = ReferenceKind::WithError;
  } else if (!o.referenceExact) {
    r.kind = ReferenceKind::Scatter;
  }
  return r;
}

image::Evidence fileEvidence(const VerifyOptions& o, const FileReference& r, const image::Picture& mean) {
  const uint32_t coarse = kCoarse * o.tile;
  switch (r.kind) {
    case ReferenceKind::WithError:
      return image::pictureEvidence(r.picture, r.error, restartsOf(r.error), o.tile, coarse);
    case ReferenceKind::Scatter:
      return image::scatterEvidence(r.picture, mean, o.tile, coarse);
    default:
      return image::exactEvidence(r.picture, o.tile, coarse);
  }
}

/// A reference of far fewer restarts: what comes rarely may have been seen by one side alone. Far more are no fault,
/// a well-sampled reference is what one wants.
void warnOfFewer(uint64_t own, uint64_t reference, const std::function<void(const std::string&)>& warn) {
  if (2 * reference >= own) return;
  warn(
      fmt::format("{} restarts against {} of the reference: light that comes rarely may have been seen by one side "
                  "alone; as many of it are safer",
                  own, reference));
}

/// Restarts at each look: `restarts`, twice that, … up to `mostRestarts`.
std::vector<uint32_t> looksOf(const VerifyOptions& o) {
  std::vector<uint32_t> looks{o.restarts};
  while (looks.back() < o.mostRestarts)
    looks.push_back(static_cast<uint32_t>(std::min<uint64_t>(uint64_t{2} * looks.back(), o.mostRestarts)));
  return looks;
}

void writePicture(const VerifyOptions& o, const Verification& v) {
  if (o.picture.ends_with(".png")) {
    const double full = fullColour(v.verdict, o.verdict.tolerance);
    image::writePng(o.picture, verificationMap(v, full), image::Encoding::Display);
    return;
  }
  image::Picture difference = v.mean;
  for (size_t i = 0; i < difference.rgba.size(); ++i) difference.rgba[i] -= v.referenceMean.rgba[i];
  difference.attributes = {{"weir.scene", v.scene},
                           {"weir.camera", v.camera},
                           {"weir.lights", v.lights},
                           {"weir.animation", v.animation},
                           {"weir.verdict", image::answerName(v.verdict.answer)},
                           {"weir.content", "mean over restarts minus reference"}};
  image::writeExr(o.picture, difference);
}

}  // namespace

Verification verify(const VerifyOptions& o) {
  checkOptions(o);
  Verification v;
  const auto warn = [&](const std::string& text) {
    v.warnings.push_back(text);
    if (o.warn) o.warn(text);
  };
  Laboratory laboratory(o.pluginPaths);
  graph::CompiledGraph graph = laboratory.compile(o.graph, o.overrides, o.width, o.height);
  requirePicture(graph, o.graph, o.output);
  FileReference file;
  graph::CompiledGraph referenceGraph;
  if (o.reference.empty()) {
    const bool bundled = o.referenceGraph.empty();
    v.referenceName = bundled ? bundledGraph("reference.json") : o.referenceGraph;
    graph::Overrides overrides = o.referenceOverrides;
    if (bundled) overrides.set.insert(overrides.set.begin(), "path.maxBounces=0");
    referenceGraph = laboratory.compile(v.referenceName, overrides, o.width, o.height);
    requirePicture(referenceGraph, v.referenceName, "radiance");
    if (o.referenceRestarts > 0) warnOfFewer(o.restarts, o.referenceRestarts, warn);
  } else {
    v.referenceName = o.reference;
    file = readReference(o);
    v.kind = file.kind;
    image::requireNotNegative(image::exactEvidence(file.picture, o.tile, kCoarse * o.tile), v.referenceName);
    if (v.kind == ReferenceKind::WithError && restartsOf(file.error) < 2)
      warn(fmt::format("'{}' doesn't say of how many restarts it is; taken as of two", o.referenceError));
    else if (v.kind == ReferenceKind::WithError)
      warnOfFewer(o.restarts, restartsOf(file.error), warn);
    if (v.kind == ReferenceKind::Scatter)
      warn(fmt::format(
          "nothing is known of the error of '{}' (--reference-stderr FILE, or --reference-exact for a closed "
          "form): it is taken from how its pixels scatter, which finds less",
          o.reference));
  }
  laboratory.open(o.stage, o.device, static_cast<float>(o.width) / static_cast<float>(o.height));
  const Stage& stage = laboratory.stage();
  for (const std::string& warning : stage.scene.warnings) warn(warning);
  if (!o.reference.empty()) requireSameSubject(stage, animationOf(o, stage), o.reference, file.picture);
  v.device = laboratory.device().info().name;
  v.scene = stage.sceneLabel;
  v.lights = stage.lightsLabel;
  v.camera = stage.cameraLabel;
  v.animation = animationOf(o, stage);

  const bool moves = stage.playback.has_value();
  Restarts restarts(laboratory, std::move(graph),
                    {o.output, o.frames, o.firstFrame, o.seed, moves, parseLanes(o.lanes)});
  v.lanes = restarts.lanes();
  if (restarts.executor().meaning(o.output) == Meaning::Display)
    warn(fmt::format("output '{}' holds display values: the mean of tone-mapped pictures is not the tone-mapped mean",
                     o.output));
  std::unique_ptr<Restarts> rendered;
  if (o.reference.empty()) {
    // Seeds of its own: of the same graph the reference is another sample, not the same one again.
    RestartOptions r{"radiance",
                     moves ? 1 : o.referenceFrames,
                     moves ? static_cast<uint32_t>(lastFrame(o)) : o.firstFrame,
                     restartSeed(o.seed, ~0u),
                     moves,
                     parseLanes(o.lanes)};
    rendered = std::make_unique<Restarts>(laboratory, std::move(referenceGraph), r);
    v.referenceLanes = rendered->lanes();
  }

  const auto collect = [&](Restarts& from, image::EvidenceCollector& into, uint32_t until, const char* what,
                           double& seconds) {
    const Clock::time_point start = Clock::now();
    const uint32_t first = from.done();
    if (until <= first) return;
    from.run(until - first, [&](std::span<const image::Picture> pictures) {
      into.add(pictures);
      if (o.progress) o.progress(what, into.restarts(), until);
    });
    seconds = secondsSince(start) / (until - first);
  };
  image::EvidenceCollector measured(o.tile, kCoarse * o.tile), truth(o.tile, kCoarse * o.tile);
  image::VerdictOptions options = o.verdict;
  const std::vector<uint32_t> looks = looksOf(o);
  options.looks = v.looks = static_cast<int>(looks.size());
  for (v.look = 1;; ++v.look) {
    const uint32_t count = looks[static_cast<size_t>(v.look - 1)];
    collect(restarts, measured, count, "restarts", v.secondsPerRestart);
    v.mean = measured.mean();
    image::Evidence reference;
    if (rendered) {
      const uint64_t wanted = o.referenceRestarts == 0 ? count : uint64_t{o.referenceRestarts} * count / o.restarts;
      collect(*rendered, truth, static_cast<uint32_t>(std::min<uint64_t>(wanted, ~0u)), "restarts of the reference",
              v.secondsPerReferenceRestart);
      if (const image::NonFinite& bad = truth.nonFinite(); bad.pixels > 0)
        throw RuntimeError(
            fmt::format("the reference itself has {} pixels that are not finite, the first at {}, {} of restart {}",
                        bad.pixels, bad.x, bad.y, bad.restart));
      reference = truth.evidence();
      image::requireNotNegative(reference, v.referenceName);
      v.referenceMean = truth.mean();
    } else {
      reference = fileEvidence(o, file, v.mean);
      v.referenceMean = file.picture;
    }
    v.verdict = image::decide(measured.evidence(), reference, measured.nonFinite(), options);
    if (v.verdict.answer != image::Answer::Undecided || v.look == v.looks) break;
  }
  // Of a file nobody knows whether events that the graph's restarts lack are behind it.
  if (v.verdict.answer == image::Answer::Biased && v.kind == ReferenceKind::WithError &&
      2 * v.verdict.restarts < restartsOf(file.error))
    warn(fmt::format(
        "'{}' is of {} restarts, more than twice the {} here: light that comes too rarely for these looks like "
        "a bias; --restarts {} tells the two apart",
        o.reference, restartsOf(file.error), v.verdict.restarts, restartsOf(file.error)));
  if (o.device.validation) laboratory.requireNoValidationMessages();
  if (!o.picture.empty()) writePicture(o, v);
  if (!o.json.empty()) writeTextFile(o.json, verificationJson(v, o));
  return v;
}

}  // namespace weir::render
