#include <weir/chart/pictures.h>

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <map>
#include <unordered_map>

namespace weir::chart {
namespace {

constexpr size_t kLargestPicture = size_t{8} << 20u;

/// Empty, with a warning, when the file can't be shown.
std::string readPng(const std::string& path, std::vector<std::string>& warnings) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(kLargestPicture + 1, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  const char* wrong = nullptr;
  if (bytes.size() > kLargestPicture) {
    wrong = "larger than 8 MiB";
  } else if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) {
    wrong = bytes.empty() ? "empty or not readable" : "no PNG";
  }
  if (wrong == nullptr) return bytes;
  warnings.push_back(fmt::format("picture {} is left out: {}", path, wrong));
  return "";
}

}  // namespace

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t given = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8u | (k < given ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += k <= given ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

EmbeddedPictures embedPictures(const Bench& bench, const std::vector<size_t>& order, size_t mostBytes,
                               std::vector<std::string>& warnings) {
  EmbeddedPictures result;
  result.of.assign(bench.configurations.size(), {-1, -1, -1});
  std::map<std::string, int> byPath;               // −1: can't be shown
  std::unordered_map<std::string, int> byContent;  // of base64
  size_t taken = 0;
  for (const size_t c : order) {
    const PicturePaths& paths = bench.configurations[c].pictures;
    const std::array<const std::string*, 3> wanted = {&paths.frame, &paths.reference, &paths.flip};
    std::map<std::string, std::string> fresh;
    size_t more = 0;
    for (const std::string* path : wanted) {
      if (path->empty() || byPath.contains(*path) || fresh.contains(*path)) continue;
      std::string bytes = readPng(*path, warnings);
      if (bytes.empty()) byPath[*path] = -1;
      std::string text = base64(bytes);
      if (!byContent.contains(text)) more += bytes.size();
      if (!bytes.empty()) fresh[*path] = std::move(text);
    }
    if (taken + more > mostBytes) {
      ++result.leftOut;
      continue;
    }
    taken += more;
    for (auto& [path, text] : fresh) {
      const auto [entry, isNew] = byContent.emplace(text, static_cast<int>(result.base64.size()));
      if (isNew) result.base64.push_back(text);
      byPath[path] = entry->second;
    }
    for (size_t k = 0; k < 3; ++k)
      if (const auto found = byPath.find(*wanted[k]); found != byPath.end()) result.of[c][k] = found->second;
  }
  return result;
}

}  // namespace weir::chart
