// `weir verify`: is a graph's estimator unbiased on a scene? Runs independent restarts of the graph, gets a reference
// from a file or from restarts of a brute-force graph, and has image/verdict.h decide. docs/verify.md is the manual.
#pragma once

#include <weir/graph/description.h>
#include <weir/image/verdict.h>
#include <weir/render/laboratory.h>

#include <functional>
#include <string>
#include <vector>

namespace weir::render {

struct VerifyOptions {
  std::string graph;
  graph::Overrides overrides;
  StageOptions stage;
  DeviceChoice device;
  std::vector<std::string> pluginPaths;
  uint32_t width = 256, height = 256;
  uint32_t restarts = 64;
  /// Undecided after `restarts`: twice as many, and so on up to this. Every such look is paid for in advance: each gets
  /// its share of alpha. 0: as `restarts`, one look.
  uint32_t mostRestarts = 0;
  uint32_t frames = 4, firstFrame = 0;
  uint32_t seed = 0;
  std::string lanes = "auto";  ///< restarts at a time, as `--lanes` (render/lanes.h)
  std::string output = "radiance";

  std::string reference;        ///< file; empty: rendered here
  std::string referenceError;   ///< file with the standard error of each of its pixels
  bool referenceExact = false;  ///< the file has no error: a closed form, say
  std::string referenceGraph;   ///< empty: the bundled reference.json, direct light only
  graph::Overrides referenceOverrides;
  uint32_t referenceRestarts = 0;  ///< 0: as many as `restarts`
  uint32_t referenceFrames = 1;    ///< of a restart of a still scene

  uint32_t tile = 16;             ///< side of fine tiles, pixels; coarse ones have four times that
  image::VerdictOptions verdict;  ///< `looks` is worked out here

  std::string picture;  ///< .png: a map of tiles; .exr: difference per pixel; empty: none
  std::string json;
  std::function<void(const std::string&, uint64_t, uint64_t)> progress;  ///< what is done, how much, of how much
  std::function<void(const std::string&)> warn;
};

enum class ReferenceKind : unsigned char { Rendered, WithError, Exact, Scatter };

struct Verification {
  image::Verdict verdict;
  ReferenceKind kind = ReferenceKind::Rendered;
  std::string referenceName;  ///< graph or file
  std::string device, scene, lights, camera, animation;
  double secondsPerRestart = 0, secondsPerReferenceRestart = 0;
  uint32_t lanes = 1, referenceLanes = 1;  ///< restarts that ran at a time
  int look = 1, looks = 1;
  std::vector<std::string> warnings;  ///< that `warn` was given
  image::Picture mean, referenceMean;
};

/// Throws InputError (files, sizes, pictures of something else, …), graph::GraphError, RuntimeError.
Verification verify(const VerifyOptions& options);

/// Raw numbers: every tile's means, standard errors, t, p.
std::string verificationJson(const Verification& v, const VerifyOptions& options);

/// Two maps of fine tiles side by side over a faint picture: how much (relative difference, blue darker, red brighter,
/// full at `full`) and how sure (|t| over what alarms, full at 1). Tiles that alarm have a yellow rim. 8-bit display
/// values.
image::Picture verificationMap(const Verification& v, double full);
/// The relative difference that the map's colours are full at: the largest of what alarms, the tolerance at least.
double fullColour(const image::Verdict& verdict, double tolerance);

}  // namespace weir::render
