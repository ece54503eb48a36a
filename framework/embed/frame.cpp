// One frame of a graph as a node of the host's, and its times.
#include <weir/embed/call.h>

#include <cmath>

using namespace weir;
using namespace weir::embed;

namespace {

static_assert(WEIR_SLOTS == execute::SceneFrame::kSlots);

glm::vec3 vector(const float (&v)[3], const char* what) {
  const glm::vec3 result(v[0], v[1], v[2]);
  if (!std::isfinite(result.x) || !std::isfinite(result.y) || !std::isfinite(result.z))
    throw InputError(fmt::format("WeirCamera.{} is not finite", what));
  return result;
}

scene::Camera camera(const WeirCamera& from) {
  scene::Camera c;
  c.eye = vector(from.eye, "eye");
  const glm::vec3 forward = vector(from.forward, "forward"), up = vector(from.up, "up");
  if (!(glm::length(forward) > 0.0f) || !(glm::length(up) > 0.0f))
    throw InputError("WeirCamera.forward and up must have a length");
  c.forward = glm::normalize(forward);
  const glm::vec3 across = glm::cross(c.forward, glm::normalize(up));
  if (!(glm::length(across) > 1e-6f)) throw InputError("WeirCamera.forward and up are parallel");
  c.up = glm::normalize(glm::cross(across, c.forward));
  if (!(from.verticalFov > 0.0f && from.verticalFov < 3.14159265f))
    throw InputError(
        fmt::format("WeirCamera.verticalFov is {}; expected more than 0 and less than pi", from.verticalFov));
  c.verticalFov = from.verticalFov;
  return c;
}

execute::FrameInput input(WeirGraph& graph, const WeirFrame& frame) {
  render::Player& player = graph.scene.player;
  if (frame.time != nullptr && !(std::isfinite(*frame.time) && *frame.time >= 0.0))
    throw InputError(fmt::format("WeirFrame.time is {}; expected 0 or more seconds", *frame.time));
  execute::FrameInput in = frame.time == nullptr ? player.frame(frame.index, frame.seed)
                                                 : player.frameAt(*frame.time, frame.index, frame.seed);
  if (frame.camera != nullptr) in.camera = camera(*frame.camera);
  in.cut = frame.cut != 0;
  return in;
}

void checkTimestamps(const gpu::Device& device) {
  if (device.capabilities().timestampPeriod == 0.0f)
    throw InputError(fmt::format("{} has no timestamps in this queue family", device.info().name));
}

}  // namespace

/// From here on these queries are this frame's: before it has run there is nothing in them, and not an older one's
/// times.
void WeirGraph::timeWith(VkQueryPool queries, uint32_t first) {
  const auto passes = static_cast<uint32_t>(runtime->graph().passes.size());
  vkResetQueryPool(scene.context.device.handle(), queries, first, passes + 2);
  std::erase_if(timed, [&](const Timed& t) { return t.queries == queries && t.first == first; });
  timed.push_back({queries, first, passes});
}

uint32_t WeirGraph::passesTimedWith(VkQueryPool queries, uint32_t first) const {
  for (const Timed& t : timed)
    if (t.queries == queries && t.first == first) return t.passes;
  throw InputError("no frame of this graph was recorded with these queries");
}

WeirStatus weirRecord(WeirGraph* graph, VkCommandBuffer commands, const WeirFrame* frame) {
  return call(weirOf(graph), [&] {
    const WeirFrame& f = sized(frame, "WeirFrame");
    if (commands == VK_NULL_HANDLE) throw InputError("the command buffer is VK_NULL_HANDLE");
    execute::Stamps stamps;
    if (f.queries != VK_NULL_HANDLE) checkTimestamps(graph->scene.context.device);
    stamps.queries = f.queries;
    stamps.firstQuery = f.firstQuery;
    if (f.queries != VK_NULL_HANDLE) graph->timeWith(f.queries, f.firstQuery);
    graph->record(commands, input(*graph, f), f.slot, stamps);
  });
}

WeirStatus weirDescribePasses(WeirGraph* graph, uint32_t* queries) {
  Weir* weir = weirOf(graph);
  return call(weir, [&] {
    const auto& passes = graph->runtime->graph().passes;
    for (const graph::CompiledPass& pass : passes) weir->lines.push_back(pass.name);
    if (queries != nullptr) *queries = static_cast<uint32_t>(passes.size() + 2);
  });
}

WeirStatus weirReadTimes(WeirGraph* graph, VkQueryPool queries, uint32_t firstQuery, double* milliseconds,
                         uint32_t count) {
  return call(weirOf(graph), [&] {
    const gpu::Device& device = graph->scene.context.device;
    (void)given(milliseconds, "milliseconds");
    if (queries == VK_NULL_HANDLE) throw InputError("the query pool is VK_NULL_HANDLE");
    checkTimestamps(device);
    const size_t passes = graph->passesTimedWith(queries, firstQuery);
    if (count != passes)
      throw InputError(fmt::format("room for the times of {} passes; the frame had {}", count, passes));
    std::vector<uint64_t> ticks(passes + 2);
    const VkResult result =
        vkGetQueryPoolResults(device.handle(), queries, firstQuery, static_cast<uint32_t>(ticks.size()),
                              ticks.size() * sizeof(uint64_t), ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
    if (result == VK_NOT_READY) throw OtherStatus{WEIR_NOT_READY, "the frame is not done yet"};
    gpu::check(result, "vkGetQueryPoolResults");
    for (size_t p = 0; p < passes; ++p)
      milliseconds[p] = static_cast<double>(ticks[p + 2] - ticks[p + 1]) * device.capabilities().timestampPeriod * 1e-6;
  });
}
