#include "view/engine/messages.h"

#include <algorithm>

namespace weir::view {

void Messages::add(Severity severity, const std::string& topic, const std::string& text) {
  clear(topic);
  all_.push_back({severity, topic, text, next_++, std::chrono::steady_clock::now()});
  if (all_.size() <= kMost) return;
  const auto least = std::ranges::find_if(all_, [](const Message& m) { return m.severity == Severity::Info; });
  all_.erase(least != all_.end() ? least : all_.begin());
}

void Messages::clear(const std::string& topic) {
  std::erase_if(all_, [&](const Message& m) { return m.topic == topic; });
}

void Messages::dismiss(uint64_t number) {
  std::erase_if(all_, [&](const Message& m) { return m.number == number; });
}

void Messages::expire(std::chrono::steady_clock::time_point now) {
  std::erase_if(all_, [&](const Message& m) { return m.severity == Severity::Info && now - m.born > kNews; });
}

}  // namespace weir::view
