// Pipelines that are in use, by what they were made from: a graph that takes another's place finds those that did not
// change, so that only edited shaders are compiled by the driver.
#pragma once

#include <weir/execute/pipelines.h>

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace weir::execute {

class PipelineLibrary {
 public:
  /// The pipeline for this key, made by `make` when nobody has it. It lives as long as somebody holds it.
  std::shared_ptr<Pipeline> get(const std::string& key, const std::function<Pipeline()>& make);
  /// How many were made so far.
  uint64_t made() const { return made_; }

 private:
  std::map<std::string, std::weak_ptr<Pipeline>> known_;
  uint64_t made_ = 0;
};

}  // namespace weir::execute
