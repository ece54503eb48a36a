// What Vulkan's barriers mean, for every byte that a graph uses: runs a compiled graph frame after frame and says what
// is wrong. Knows accesses and barriers only, and nothing of how they were planned.
//
// Each access is followed on its own, as the validation layers do, by what barriers have happened since:
//   ordered    stages whose later work comes after the access
//   readable, writable   stages whose later reads and writes see it, after a write
// Reading wants readable. Overwriting wants: of reads that they are ordered before; of a write that nobody read since,
// writable (one that was read is over when the reads are). Stricter than Vulkan in two ways, again as the validation
// layers are: barriers don't chain by way of other stages, and an image's own barrier is trusted with that image alone.
#pragma once

#include <weir/graph/compile.h>

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace weir::graph::test {

class MemoryModel {
 public:
  explicit MemoryModel(const CompiledGraph& graph) : graph_(graph) { cut(); }

  /// The first thing that goes wrong in so many frames; empty when nothing does.
  std::string run(int frames) {
    for (frame_ = 0; frame_ < frames && fault_.empty(); ++frame_) {
      for (const CompiledPass& pass : graph_.passes) step(pass);
      lookAtOutputs();
    }
    return fault_;
  }

 private:
  static constexpr int kUndefined = -2;  ///< in place of a resource: nobody's content

  struct Access {
    Stages stage = 0;  ///< one bit
    Stages ordered = 0, readable = 0, writable = 0;
  };
  /// Bytes that are always used together.
  struct Piece {
    int resource = kUndefined, frame = -1;  ///< whose content, and of which frame
    std::vector<Access> write, reads;       ///< the last write by stage, and the reads since
  };

  /// Splits each block where resources begin and end; all other memory is a piece by itself, history two.
  void cut() {
    places_.resize(graph_.resources.size());
    for (uint32_t b = 0; b < graph_.blocks.size(); ++b) {
      std::set<uint64_t> ends;
      for (const Resource& r : graph_.resources)
        if (r.block == b) ends.insert({r.offset, r.offset + r.memoryBytes});
      std::vector<uint64_t> points(ends.begin(), ends.end());
      for (size_t i = 0; i + 1 < points.size(); ++i) {
        for (uint32_t r = 0; r < graph_.resources.size(); ++r) {
          const Resource& a = graph_.resources[r];
          if (a.block == b && a.offset <= points[i] && points[i + 1] <= a.offset + a.memoryBytes)
            places_[r].push_back(pieces_.size());
        }
        pieces_.emplace_back();
      }
    }
    for (uint32_t r = 0; r < graph_.resources.size(); ++r) {
      const Resource& a = graph_.resources[r];
      if (a.block != kNone) continue;
      for (int copy = 0; copy < (a.history ? 2 : 1); ++copy) {
        places_[r].push_back(pieces_.size());
        // History starts as if cleared before the first frame, everything visible.
        pieces_.push_back({a.history ? static_cast<int>(r) : kUndefined, -1, {}, {}});
      }
    }
  }

  std::vector<size_t> piecesOf(uint32_t resource, int frame) const {
    if (!graph_.resources[resource].history) return places_[resource];
    return {places_[resource][static_cast<size_t>(frame + 2) % 2]};
  }

  void step(const CompiledPass& pass) {
    barriers(pass);
    for (const Binding& input : pass.inputs)
      if (input.resource != kNone) read(pass, input.resource, frame_ - (input.previous ? 1 : 0));
    for (const Binding& output : pass.outputs) write(pass, output.resource);
    for (const uint32_t scratch : pass.scratch) write(pass, scratch);
  }

  // ------------------------------------------------------------------------------------------------ barriers

  /// All barriers before a pass are one command: images change their layout after what it makes available.
  void barriers(const CompiledPass& pass) {
    std::vector<size_t> transitions;
    for (const ImageStart& s : pass.starts)
      for (const size_t place : piecesOf(s.resource, frame_)) {
        const Piece& piece = pieces_[place];
        const std::string who = graph_.resources[s.resource].name + "'s start";
        for (const Access& a : piece.reads.empty() ? piece.write : piece.reads)
          if ((a.stage & s.from) == 0) blame(who, piece, "may still be in use");
        transitions.push_back(place);
      }
    for (Piece& piece : pieces_)
      for (std::vector<Access>* list : {&piece.write, &piece.reads})
        for (Access& a : *list)
          for (const Wait& w : pass.waits) {
            if ((a.stage & w.from) == 0) continue;
            a.ordered |= w.to;
            if (w.writes && w.toReads) a.readable |= w.to;
            if (w.writes && w.toWrites) a.writable |= w.to;
          }
    for (const size_t place : transitions) {
      Piece& piece = pieces_[place];
      for (const Access& a : piece.write)
        if (piece.reads.empty() && (pass.stages & ~a.writable) != 0) blame("a start", piece, "may still be written");
      piece = {kUndefined, frame_, {}, {}};
    }
  }

  // ------------------------------------------------------------------------------------------------ accesses

  void read(const CompiledPass& pass, uint32_t resource, int frame) {
    for (const size_t place : piecesOf(resource, frame)) {
      Piece& piece = pieces_[place];
      if (piece.resource != static_cast<int>(resource) || piece.frame != frame) {
        if (frame >= 0 || piece.frame >= 0) blame(pass.name, piece, "is there in place of " + nameOf(resource, frame));
      }
      for (const Access& a : piece.write)
        if ((pass.stages & ~a.readable) != 0) blame(pass.name, piece, "is not visible");
      add(piece.reads, pass.stages);
    }
  }

  void write(const CompiledPass& pass, uint32_t resource) {
    for (const size_t place : piecesOf(resource, frame_)) {
      Piece& piece = pieces_[place];
      for (const Access& a : piece.reads)
        if ((pass.stages & ~a.ordered) != 0) blame(pass.name, piece, "may still be read");
      for (const Access& a : piece.write)
        if (piece.reads.empty() && (pass.stages & ~a.writable) != 0) blame(pass.name, piece, "may still be written");
      const bool foreign = piece.resource != kUndefined && piece.resource != static_cast<int>(resource);
      if (graph_.resources[resource].isImage() && foreign) blame(pass.name, piece, "was no image in its layout");
      piece = {static_cast<int>(resource), frame_, {}, {}};
      add(piece.write, pass.stages);
    }
  }

  static void add(std::vector<Access>& list, Stages stages) {
    for (const Stages stage : {kComputeStage, kRayStage, kRasterStage})
      if ((stages & stage) != 0) list.push_back({stage});
  }

  /// By the host, with barriers of its own around it: what matters is whose content is there.
  void lookAtOutputs() {
    const auto look = [&](uint32_t resource, int frame) {
      for (const size_t place : piecesOf(resource, frame)) {
        const Piece& piece = pieces_[place];
        if (frame >= 0 && (piece.resource != static_cast<int>(resource) || piece.frame != frame))
          blame("the host", piece, "is there in place of " + nameOf(resource, frame));
      }
    };
    for (const GraphOutput& output : graph_.outputs) look(output.resource, frame_ - (output.previous ? 1 : 0));
    for (uint32_t r = 0; r < graph_.resources.size(); ++r)
      if (graph_.resources[r].kept) look(r, frame_);
  }

  std::string nameOf(int resource, int frame) const {
    if (resource == kUndefined) return "rubbish";
    return fmt::format("{} of frame {}", graph_.resources[static_cast<size_t>(resource)].name, frame);
  }
  std::string nameOf(uint32_t resource, int frame) const { return nameOf(static_cast<int>(resource), frame); }

  void blame(const std::string& who, const Piece& piece, const std::string& what) {
    if (fault_.empty())
      fault_ = fmt::format("frame {}, {}: {} {}", frame_, who, nameOf(piece.resource, piece.frame), what);
  }

  const CompiledGraph& graph_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<size_t>> places_;  ///< by resource: its pieces
  int frame_ = 0;
  std::string fault_;
};

}  // namespace weir::graph::test
