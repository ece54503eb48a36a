// What went wrong or was done, for the user to read: kept while it matters, never a reason to end.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace weir::view {

enum class Severity : uint8_t { Info, Warning, Error };

struct Message {
  Severity severity = Severity::Info;
  std::string topic;  ///< what it is of: "graph", "shader", "scene", …; a newer one replaces an older one
  std::string text;   ///< complete, with places; several lines
  uint64_t number = 0;
  std::chrono::steady_clock::time_point born{};
};

/// Errors stay until what they are of works again or the user dismisses them; others make room for newer ones.
class Messages {
 public:
  void add(Severity severity, const std::string& topic, const std::string& text);
  /// What was wrong with it is mended.
  void clear(const std::string& topic);
  void dismiss(uint64_t number);
  /// News that was there to be read for some seconds goes.
  void expire(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
  const std::vector<Message>& all() const { return all_; }

 private:
  static constexpr size_t kMost = 20;
  static constexpr std::chrono::seconds kNews{12};
  std::vector<Message> all_;
  uint64_t next_ = 1;
};

}  // namespace weir::view
