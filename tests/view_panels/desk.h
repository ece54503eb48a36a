// A graph on a desk of its own: the panel, what it draws and what becomes of its requests, without the rest of the
// window.
#pragma once

#include "view/document/edits.h"
#include "view/document/model.h"
#include "view/panels/graph_panel.h"

#include <weir/core/error.h>
#include <weir/graph/compile.h>

#include <gtest/gtest.h>
#include <imgui.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/ui_robot.h"

namespace weir::view::test {

using weir::test::UiRobot;

/// A document behind the panel, whose requests are carried out between two frames.
class Desk {
 public:
  Desk(Document document, const graph::PassCatalog& catalog, bool named = true)
      : document_(std::move(document)), context_{catalog, 64, 64} {
    rebuild();
    robot = std::make_unique<UiRobot>([this](Ui& ui) { draw(ui); }, glm::vec2{1280.0f, 720.0f}, named);
  }

  Document& document() { return document_; }
  const GraphModel& model() const { return model_; }
  /// Requests of all frames since the last look.
  std::vector<GraphRequests> take() { return std::exchange(asked_, {}); }
  /// The only edit that was asked for since then.
  template <typename T>
  T only() {
    std::vector<T> found;
    for (const GraphRequests& requests : take())
      for (const Edit& edit : requests.edits)
        if (const T* e = std::get_if<T>(&edit)) found.push_back(*e);
    EXPECT_EQ(found.size(), 1u);
    return found.empty() ? T{} : found.front();
  }
  void rebuild() {
    std::vector<graph::Diagnostic> findings;
    graph::CompiledGraph compiled = graph::compile(document_.description(), context_.catalog, 64, 64, findings);
    if (findings.empty()) running_ = std::move(compiled);
    model_ = buildModel({document_, context_, &running_, problemsOf(findings), choicesOf_});
  }

  GraphPanelState state;
  std::unique_ptr<UiRobot> robot;
  bool carriesOut = true;

 private:
  void draw(Ui& ui) {
    ImGui::SetNextWindowPos({0.0f, 0.0f});
    ImGui::SetNextWindowSize({340.0f, 720.0f});
    ImGui::Begin("Graph", nullptr, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar);
    GraphRequests requests = drawGraphPanel(ui, model_, state);
    ImGui::End();
    if (!requests.choicesOf.empty()) choicesOf_ = requests.choicesOf;
    if (!requests.show.empty()) state.shown = requests.show;
    if (carriesOut)
      for (const Edit& edit : requests.edits) {
        try {
          carryOut(document_, context_, edit);
        } catch (const InputError& error) {
          refused_ = error.what();
        }
      }
    if (!requests.edits.empty() || !requests.choicesOf.empty()) rebuild();
    asked_.push_back(std::move(requests));
  }

  Document document_;
  SwapContext context_;
  graph::CompiledGraph running_;
  GraphModel model_;
  std::string choicesOf_, refused_;
  std::vector<GraphRequests> asked_;
};

}  // namespace weir::view::test
