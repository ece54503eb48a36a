#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/render/bench.h>
#include <weir/render/bench_command.h>
#include <weir/render/bench_error.h>
#include <weir/render/bench_file.h>
#include <weir/render/bench_identity.h>
#include <weir/render/bench_measure.h>
#include <weir/render/bench_pictures.h>
#include <weir/render/bench_plan.h>
#include <weir/render/bench_sweep.h>
#include <weir/render/reference_picture.h>
#include <weir/render/write_file.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

namespace weir::render {
namespace {

namespace fs = std::filesystem;

void checkReference(const BenchPart& part, const BenchSettings& settings) {
  const BenchReference& r = part.reference;
  if (!r.file.empty() && !r.graph.empty()) throw InputError("--reference and --reference-graph: only one of them");
  if (r.graph.empty() && (!r.overrides.set.empty() || r.frames != 1 || r.restarts != 2))
    throw InputError("--reference-set, --reference-frames and --reference-restarts need --reference-graph");
  if (!r.wanted() && r.exact) throw InputError("--reference-exact needs --reference");
  if (r.frames == 0) throw InputError("--reference-frames must be at least 1");
  if (r.restarts == 0) throw InputError("--reference-restarts must be at least 1");
  if (!r.wanted()) return;
  if (part.stage.animate)
    throw InputError("--reference with --animate: frames of a clip show different moments, a reference one of them");
  requireFrameNumbers(settings.firstFrame, "--reference-frames", r.frames);
  cropOf(settings.crop, part.width, part.height);
}

void checkOptions(const BenchOptions& o) {
  checkSettings(o.settings);
  if (o.shards == 0 || o.shard >= o.shards)
    throw InputError(fmt::format("--shard {}/{}: expected I/N with 0 ≤ I < N", o.shard, o.shards));
  if (fs::path(o.out).extension() != ".json")
    throw InputError(fmt::format("--out {}: the file must end in .json", o.out));
  const std::string csv = besideBenchFile(o.out, ".csv"), pictures = besideBenchFile(o.out, ".pictures");
  checkWritable(o.out);
  checkWritable(csv);
  std::error_code ignored;
  if (fs::exists(pictures, ignored) && !fs::is_directory(pictures, ignored))
    throw InputError(fmt::format("can't write into {}: that is no folder", pictures));
  std::vector<NamedPath> read{{"--plan", o.plan}};
  for (const BenchPart& part : o.parts) {
    requireSize(part.width, part.height);
    if (part.stage.scene.empty()) throw InputError("--scene is required");
    checkReference(part, o.settings);
    for (const std::string& graph : part.graphs) read.emplace_back("the graph", graph);
    read.emplace_back("--scene", part.stage.scene);
    read.emplace_back("--environment", part.stage.environment);
    read.emplace_back("--reference", part.reference.file);
    read.emplace_back("--reference-graph", part.reference.graph);
  }
  requireDistinct({{"--out", o.out}, {"the CSV of --out", csv}}, read);
}

float aspectOf(const BenchPart& part) {
  return static_cast<float>(part.width) / static_cast<float>(part.height);
}

class Bench {
 public:
  Bench(const BenchOptions& o, const std::function<void(const BenchRecord&)>& done)
      : o_(o), done_(done), laboratory_(o.pluginPaths), build_(laboratory_.registry()) {}

  BenchOutcome run() {
    configurations_ = expand(laboratory_, o_.parts);
    for (const BenchPart& part : o_.parts) checkReferenceOf(part);
    for (const Configuration& c : configurations_)
      if (o_.parts[c.part].reference.wanted()) requirePicture(c.compiled, c.graph, o_.settings.output);
    identify();
    resume();
    BenchOutcome outcome;
    outcome.planned = configurations_.size();
    std::vector<Configuration*> left;
    for (size_t i = 0; i < configurations_.size(); ++i) {
      if (i % o_.shards != o_.shard) continue;
      ++outcome.own;
      if (file_.has(configurations_[i].id))
        ++outcome.there;
      else
        left.push_back(&configurations_[i]);
    }
    writeBenchFile(o_.out, file_);  // that it can be, and what it will hold
    for (Configuration* c : left) {
      if (o_.progress) o_.progress(c->label, ++outcome.measured, left.size());
      measure(*c);
    }
    outcome.measured = left.size();
    if (o_.device.validation) laboratory_.requireNoValidationMessages();
    return outcome;
  }

 private:
  /// What can be said of it before a scene is read: a file is read here and read again when it is needed, as those of
  /// many parts would fill the memory.
  void checkReferenceOf(const BenchPart& part) {
    references_.emplace_back();
    headers_.emplace_back();
    if (!part.reference.file.empty())
      headers_.back().attributes = readRadiance(part.reference.file, part.width, part.height).attributes;
    if (part.reference.graph.empty()) return;
    references_.back() = laboratory_.compile(part.reference.graph, part.reference.overrides, part.width, part.height);
    requirePicture(references_.back(), part.reference.graph, "radiance");
  }

  /// Another scene only where it is another one: reading it takes seconds.
  void openStage(size_t index) {
    const BenchPart& part = o_.parts[index];
    const float aspect = aspectOf(part);
    if (opened_ && o_.parts[*opened_].stage == part.stage && aspectOf(o_.parts[*opened_]) == aspect) return;
    executor_.reset();
    counting_.reset();
    reference_.reset();
    opened_.reset();
    laboratory_.open(part.stage, o_.device, aspect);
    opened_ = index;
    if (!warned_.insert(part.stage.scene).second || !o_.warn) return;
    for (const std::string& warning : laboratory_.stage().scene.warnings) o_.warn(warning);
    if (laboratory_.stage().prepared.lights.empty())
      o_.warn(part.stage.scene + " has no lights: its pictures will be black (--lights N adds some)");
  }

  /// Ids of all configurations; those that are the same become one.
  void identify() {
    std::vector<std::string> references;
    for (size_t p = 0; p < o_.parts.size(); ++p)
      references.push_back(referenceText(o_.parts[p].reference, references_[p], build_));
    // From the last scene to the first, which is the one that measuring starts with.
    for (size_t p = o_.parts.size(); p-- > 0;) {
      openStage(p);
      if (!o_.parts[p].reference.file.empty())
        requireSameSubject(laboratory_.stage(), "none", o_.parts[p].reference.file, headers_[p]);
      place_ = {laboratory_.device().info().name, laboratory_.device().info().driver,
                trace::backendName(laboratory_.backend())};
      for (Configuration& c : configurations_)
        if (c.part == p) c.id = identityOf(c, laboratory_.stage(), o_, place_, references[p], build_);
    }
    std::map<std::string, size_t> seen;
    std::vector<Configuration> each;
    for (Configuration& c : configurations_) {
      const auto [place, fresh] = seen.emplace(c.id, each.size());
      if (fresh) {
        each.push_back(std::move(c));
        continue;
      }
      std::vector<std::string>& sweeps = each[place->second].sweeps;
      for (const std::string& name : c.sweeps)
        if (std::ranges::count(sweeps, name) == 0) sweeps.push_back(name);
    }
    configurations_ = std::move(each);
  }

  void resume() {
    file_.device = place_.device;
    file_.driver = place_.driver;
    file_.trace = place_.trace;
    file_.weir = build_.text();
    std::error_code ignored;
    if (!o_.fresh && fs::exists(o_.out, ignored)) {
      BenchFile before = readBenchFile(o_.out);
      const std::string conflict = before.conflict(file_);
      if (!conflict.empty())
        throw InputError(fmt::format("'{}' is there already, of another {}; --fresh starts over", o_.out, conflict));
      file_.configurations = std::move(before.configurations);
    }
    file_.shard = o_.shard;
    file_.shards = o_.shards;
    for (const Configuration& c : configurations_) file_.planned.push_back({c.id, c.label, c.sweeps});
  }

  /// One executor after the other would compile every pipeline anew: a graph is swapped for the next.
  void run(std::unique_ptr<execute::Executor>& executor, const graph::CompiledGraph& graph, bool rays) {
    if (executor)
      executor->swap(graph);
    else
      executor = laboratory_.executor(graph, 1, rays);
  }

  void measure(Configuration& c) {
    openStage(c.part);
    BenchRecord record = facts(c);
    run(executor_, c.compiled, false);
    record.cost = measureCost(*executor_, laboratory_.stage(), o_.settings);
    record.cost.sceneBytes += laboratory_.sceneBytes();
    run(counting_, c.compiled, true);
    record.cost.rays = countRays(*counting_, laboratory_.stage(), o_.settings);
    if (o_.floor)
      record.floor =
          o_.floor({laboratory_, c.graph, c.overrides, executor_->graph(), o_.settings,
                    record.cost.frameGpuMs ? record.cost.frameGpuMs->median : record.cost.wallMs, record.cost.rays});
    if (o_.parts[c.part].reference.wanted()) addErrors(c, record);
    file_.configurations.push_back({c.id, recordJson(record)});
    writeBenchFile(o_.out, file_);
    if (done_) done_(record);
  }

  BenchRecord facts(const Configuration& c) const {
    const BenchPart& part = o_.parts[c.part];
    const Stage& stage = laboratory_.stage();
    BenchRecord r;
    r.id = c.id;
    r.graph = fs::path(c.graph).filename().string();
    r.name = c.compiled.name;
    r.command = benchCommand(c, o_);
    r.sceneFile = fs::path(part.stage.scene).filename().string();
    r.sceneDigest = stage.sceneLabel.substr(stage.sceneLabel.rfind(' ') + 1);
    r.lights = stage.lightsLabel;
    r.camera = stage.cameraLabel;
    r.animation = stage.playback ? "played" : "none";
    r.width = part.width;
    r.height = part.height;
    r.frames = o_.settings.frames;
    r.warmup = o_.settings.warmup;
    r.settings = c.settings;
    r.parameters = c.parameters;
    return r;
  }

  /// The reference of a part, kept while the next part's is the same.
  struct Reference {
    std::string key;
    ReferencePicture picture;
    image::RelativeErrorMeter meter;
    float scale = 1;
  };

  const Reference& referenceOf(size_t part) {
    const BenchPart& p = o_.parts[part];
    const std::string key =
        fmt::format("{}x{}\n{}", p.width, p.height, referenceText(p.reference, references_[part], build_));
    if (reference_ && reference_->key == key) return *reference_;
    reference_.reset();
    ReferencePicture picture =
        makeReference(laboratory_, p.reference, references_[part], o_.settings, p.width, p.height);
    image::RelativeErrorMeter meter(picture.picture);
    const float scale = displayScale(picture.picture);
    reference_ = std::make_unique<Reference>(Reference{key, std::move(picture), std::move(meter), scale});
    return *reference_;
  }

  void addErrors(const Configuration& c, BenchRecord& record) {
    referenceOf(c.part);
    const ErrorResult result =
        measureErrors(*executor_, laboratory_.stage(), o_.settings, reference_->picture, reference_->meter);
    record.error = result.measure;
    record.pictures = writePictures(c, result);
  }

  PictureNames writePictures(const Configuration& c, const ErrorResult& result) {
    const BenchPart& part = o_.parts[c.part];
    const fs::path folder = besideBenchFile(o_.out, ".pictures");
    fs::create_directories(folder);
    PictureNames names;
    names.crop = cropOf(o_.settings.crop, part.width, part.height);
    const auto write = [&](const std::string& name, const image::Picture& picture, image::Encoding encoding) {
      image::writePng((folder / name).string(), picture, encoding);
      return (folder.filename() / name).generic_string();
    };
    const auto radiance = [&](const image::Picture& picture) {
      return scaled(cropped(picture, names.crop), reference_->scale);
    };
    names.frame = write(c.id + ".png", radiance(result.lastFrame), image::Encoding::Radiance);
    names.reference =
        write("reference-" + c.id + ".png", radiance(reference_->picture.picture), image::Encoding::Radiance);
    if (!result.flipMap.empty())
      names.flip = write(c.id + ".flip.png", heatMap(result.flipMap, part.width, names.crop), image::Encoding::Display);
    return names;
  }

  const BenchOptions& o_;
  const std::function<void(const BenchRecord&)>& done_;
  Laboratory laboratory_;
  BuildDigest build_;
  BenchPlace place_;
  std::vector<Configuration> configurations_;
  std::vector<graph::CompiledGraph> references_;  ///< by part
  std::vector<image::Picture> headers_;           ///< of reference files, without pixels, by part
  std::set<std::string> warned_;                  ///< scenes
  std::optional<size_t> opened_;                  ///< part whose scene is on the device
  std::unique_ptr<execute::Executor> executor_, counting_;
  std::unique_ptr<Reference> reference_;
  BenchFile file_;
};

}  // namespace

BenchOutcome bench(const BenchOptions& options, const std::function<void(const BenchRecord&)>& done) {
  checkOptions(options);
  return Bench(options, done).run();
}

}  // namespace weir::render
