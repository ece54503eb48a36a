#include <fmt/format.h>
#include <weir/chart/place.h>
#include <weir/core/error.h>
#include <weir/core/text.h>

#include <cmath>
#include <vector>

namespace weir::chart {
namespace {

/// Keys come from the file: in a message they are short, and cut between characters.
std::string shortened(const std::string& text) {
  constexpr size_t kMost = 80;
  if (text.size() <= kMost) return text;
  size_t end = kMost;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
  return text.substr(0, end) + "…";
}

std::string found(const Json& value) {
  switch (value.type()) {
    case Json::value_t::object:
      return "an object";
    case Json::value_t::array:
      return fmt::format("an array of {}", value.size());
    case Json::value_t::string:
      return fmt::format("the text '{}'", shortened(value.get_ref<const std::string&>()));
    case Json::value_t::null:
      return "null";
    default:
      return shortened(value.dump());
  }
}

}  // namespace

Place Place::child(const Json& value, std::string path) const {
  Place result(*file_, value);
  result.path_ = std::move(path);
  return result;
}

Place Place::at(const std::string& key) const {
  object();
  const auto member = value_->find(key);
  if (member != value_->end()) return child(*member, path_.empty() ? key : path_ + "." + shortened(key));
  std::vector<std::string> keys;
  for (const auto& [name, ignored] : value_->items()) keys.push_back(name);
  const std::string nearest = nearestName(key, keys);
  fail(fmt::format("'{}' is missing{}", key,
                   nearest.empty() ? "" : fmt::format(" (the nearest that is there: '{}')", shortened(nearest))));
}

std::optional<Place> Place::find(const std::string& key) const {
  object();
  const auto member = value_->find(key);
  if (member == value_->end() || member->is_null()) return std::nullopt;
  return at(key);
}

Place Place::element(size_t index) const {
  return child((*value_)[index], fmt::format("{}[{}]", path_, index));
}

const Place& Place::object() const {
  if (!value_->is_object()) expected("an object");
  return *this;
}

const Place& Place::array(size_t most) const {
  if (!value_->is_array()) expected("an array");
  if (value_->size() > most) fail(fmt::format("{} elements; expected at most {}", value_->size(), most));
  return *this;
}

std::string Place::text() const {
  if (!value_->is_string()) expected("a text");
  const std::string& text = value_->get_ref<const std::string&>();
  if (text.size() > kLongestText)
    fail(fmt::format("a text of {} bytes; expected at most {}", text.size(), kLongestText));
  return text;
}

double Place::number() const {
  if (!value_->is_number()) expected("a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) expected("a finite number");
  return number;
}

double Place::atLeastZero() const {
  const double value = number();
  if (value < 0) expected("a number that is not negative");
  return value;
}

uint64_t Place::count(uint64_t most) const {
  // 1e3 is a whole number too, and some writers spell large counts that way.
  const double value = atLeastZero();
  if (std::floor(value) != value || value > static_cast<double>(most))
    fail(fmt::format("{}; expected a whole number from 0 to {}", found(*value_), most));
  return static_cast<uint64_t>(value);
}

bool Place::boolean() const {
  if (!value_->is_boolean()) expected("true or false");
  return value_->get<bool>();
}

void Place::scalar() const {
  if (value_->is_string()) {
    text();
  } else if (value_->is_number()) {
    number();
  } else if (!value_->is_boolean()) {
    expected("a text, a number or true or false");
  }
}

void Place::expected(const char* what) const {
  fail(fmt::format("{}; expected {}", found(*value_), what));
}

void Place::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: {}{}", *file_, path_.empty() ? "" : path_ + ": ", what));
}

}  // namespace weir::chart
