// Names of the widgets in the window, "graph/spatial/radius", and where they lie: scripts and tests click on what a
// name says rather than on a pixel. Panels name their widgets as they draw them.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace weir::view {

/// In window coordinates.
struct Rectangle {
  glm::vec2 low{0.0f}, high{0.0f};
  glm::vec2 centre() const { return (low + high) * 0.5f; }
  glm::vec2 size() const { return high - low; }
  bool contains(glm::vec2 p) const { return p.x >= low.x && p.y >= low.y && p.x < high.x && p.y < high.y; }
};

class Marks {
 public:
  /// Nobody asks for names unless a script runs: then they cost nothing.
  explicit Marks(bool wanted) : wanted_(wanted), looked_(wanted) {}

  /// At a frame's beginning: forgets where things were. Not `looked` at: names cost nothing in this frame, and what
  /// was found before stays.
  void begin(bool looked = true);

  /// Names the widget that ImGui drew last, below the scopes that are open.
  void last(std::string_view name);
  /// Names a part of the window that is no widget.
  void place(std::string_view name, const Rectangle& where);

  /// Names that follow lie below this one while it lives.
  class Scope {
   public:
    Scope(Marks& marks, std::string_view name);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Marks& marks_;
    size_t length_;
  };

  /// The next frame scrolls this widget into view if it can.
  void reveal(const std::string& name) { revealed_ = name; }
  struct Found {
    Rectangle where;       ///< of the whole widget
    bool visible = false;  ///< some of it is: its centre can be clicked
  };
  /// Where it was in the last frame.
  std::optional<Found> find(const std::string& name) const;
  std::vector<std::string> names() const;

 private:
  bool wanted_, looked_ = true;
  std::string scope_, revealed_;
  std::map<std::string, Found, std::less<>> found_;
};

}  // namespace weir::view
