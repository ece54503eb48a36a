#include <weir/execute/pipeline_library.h>

namespace weir::execute {

std::shared_ptr<Pipeline> PipelineLibrary::get(const std::string& key, const std::function<Pipeline()>& make) {
  std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
  if (const auto found = known_.find(key); found != known_.end()) return found->second.lock();
  auto pipeline = std::make_shared<Pipeline>(make());
  known_[key] = pipeline;
  ++made_;
  return pipeline;
}

}  // namespace weir::execute
