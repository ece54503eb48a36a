// Meshes: indices to triangles, and the attributes of the vertices that those use.
#include <weir/scene/gltf_import.h>

#include <cmath>
#include <map>

namespace weir::scene {
namespace {

constexpr uint32_t kUnused = 0xffffffffu;

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Length in double: neither tiny nor huge vectors lose it. False when the vector has no direction.
bool normalise(glm::vec3& v) {
  const double length = finite(v) ? glm::length(glm::dvec3(v)) : 0.0;
  if (!(length > 0.0)) return false;
  v = glm::vec3(glm::dvec3(v) / length);
  return true;
}

class MeshImport {
 public:
  explicit MeshImport(GltfImport& import) : import_(import) {}

  void run() {
    for (size_t m = 0; m < import_.model.meshes.size(); ++m) {
      const auto& from = import_.model.meshes[m];
      Mesh mesh;
      mesh.name = from.name;
      for (size_t p = 0; p < from.primitives.size(); ++p) {
        place_ = "/meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p);
        Primitive primitive;
        json_ = &import_.file.json().at("meshes")[m].at("primitives")[p];
        if (importPrimitive(from.primitives[p], primitive)) mesh.primitives.push_back(std::move(primitive));
      }
      import_.scene.meshes.push_back(std::move(mesh));
    }
  }

 private:
  /// From where the primitive's data is: compressed attributes have accessors without bytes.
  AccessorView accessor(const std::string& name, int index) {
    if (draco_)
      if (const auto found = draco_->attributes.find(name); found != draco_->attributes.end())
        return {found->second, draco_->vertices, import_.model.accessors[index].normalized};
    return {import_, index};
  }

  std::optional<AccessorView> attribute(const tinygltf::Primitive& from, const std::string& name, int least, int most) {
    const auto found = from.attributes.find(name);
    if (found == from.attributes.end()) return std::nullopt;
    const std::string place = place_ + "/attributes/" + name;
    const AccessorView view = accessor(name, found->second);
    if (view.components() < least || view.components() > most)
      import_.file.fail(place,
                        "has " + std::to_string(view.components()) + " components instead of " + std::to_string(least));
    if (view.componentType() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      import_.file.fail(place, "32-bit integers are no vertex attribute");
    return view;
  }

  /// A file that refers to the same bytes over and over must not fill the memory: no honest file has more triangles
  /// than bytes, and a million is free.
  uint64_t trianglesLeft() const {
    return std::min<uint64_t>(import_.limits.triangles, (1u << 20) + import_.file.loadedBytes()) - triangles_;
  }
  void countTriangles(uint64_t count) {
    if (count > trianglesLeft())
      import_.file.fail(place_, "more triangles than " + std::to_string(triangles_ + trianglesLeft()));
    triangles_ += count;
  }

  void decompress() {
    draco_.reset();
    const auto extensions = json_->find("extensions");
    if (extensions == json_->end() || !extensions->contains("KHR_draco_mesh_compression")) return;
    const auto& extension = extensions->at("KHR_draco_mesh_compression");
    std::string reason;
    draco_ = decodeDraco(import_.file.bufferView(extension.at("bufferView").get<size_t>()),
                         extension.at("attributes").get<std::map<std::string, uint32_t>>(), trianglesLeft(), reason);
    if (!reason.empty()) import_.file.fail(place_ + "/extensions/KHR_draco_mesh_compression", reason);
  }

  /// Three indices a triangle, checked against the number of vertices; the file's, before unused vertices are left out.
  std::vector<uint32_t> readTriangles(const tinygltf::Primitive& from, uint64_t vertices) {
    if (draco_ && vertices != draco_->vertices)
      import_.file.fail(place_, std::to_string(vertices) + " positions for " + std::to_string(draco_->vertices) +
                                    " compressed vertices");
    if (draco_) {
      countTriangles(draco_->indices.size() / 3);
      return std::move(draco_->indices);
    }
    std::optional<AccessorView> indices;
    if (from.indices >= 0) {
      indices.emplace(import_, from.indices);
      const int type = indices->componentType();
      if (indices->components() != 1 ||
          (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
           type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        import_.file.fail(place_ + "/indices", "not unsigned scalars");
    }
    const uint64_t n = indices ? indices->count() : vertices;
    const bool list = from.mode == TINYGLTF_MODE_TRIANGLES;
    if (list && n % 3) import_.warn("a triangle list whose length is no multiple of three ends early");
    const uint64_t count = list ? n / 3 : n < 3 ? 0 : n - 2;
    countTriangles(count);
    const auto at = [&](uint64_t i) {
      const uint64_t index = indices ? indices->index(i) : i;
      if (index >= vertices)
        import_.file.fail(place_ + "/indices", "element " + std::to_string(i) + " is " + std::to_string(index) +
                                                   ", there are " + std::to_string(vertices) + " vertices");
      return static_cast<uint32_t>(index);
    };
    std::vector<uint32_t> out;
    out.reserve(count * 3);
    for (uint64_t t = 0; t < count; ++t) {
      // Orders of glTF 2.0, section 3.7.2.1: winding alternates in strips.
      if (list)
        out.insert(out.end(), {at(3 * t), at(3 * t + 1), at(3 * t + 2)});
      else if (from.mode == TINYGLTF_MODE_TRIANGLE_FAN)
        out.insert(out.end(), {at(t + 1), at(t + 2), at(0)});
      else
        out.insert(out.end(), {at(t), at(t + 1 + t % 2), at(t + 2 - t % 2)});
    }
    return out;
  }

  /// Replaces indices by those of a dense list of used vertices, in order of first use; exporters often share one large
  /// vertex buffer among many primitives. Returns the file's index of each.
  std::vector<uint32_t> compact(std::vector<uint32_t>& indices, uint64_t vertices) {
    if (remap_.size() < vertices) remap_.resize(vertices, kUnused);
    std::vector<uint32_t> used;
    for (uint32_t& index : indices) {
      uint32_t& dense = remap_[index];
      if (dense == kUnused) {
        dense = static_cast<uint32_t>(used.size());
        used.push_back(index);
      }
      index = dense;
    }
    for (uint32_t index : used) remap_[index] = kUnused;
    return used;
  }

  void sameCount(const AccessorView& view, uint64_t vertices, const char* name) {
    if (view.count() != vertices)
      import_.file.fail(place_ + "/attributes/" + name,
                        std::to_string(view.count()) + " elements for " + std::to_string(vertices) + " positions");
  }

  bool importPrimitive(const tinygltf::Primitive& from, Primitive& to) {
    if (from.mode < TINYGLTF_MODE_TRIANGLES) {
      import_.warn("points and lines are left out");
      return false;
    }
    decompress();
    const auto positions = attribute(from, "POSITION", 3, 3);
    if (!positions) {
      import_.warn("a primitive without positions is left out");
      return false;
    }
    if (positions->count() >= kUnused) import_.file.fail(place_, "more than 32 bits of vertices");
    to.material = from.material;
    to.indices = readTriangles(from, positions->count());
    const std::vector<uint32_t> used = compact(to.indices, positions->count());

    to.positions.reserve(used.size());
    for (uint32_t i : used)
      to.positions.emplace_back(positions->value(i, 0), positions->value(i, 1), positions->value(i, 2));
    for (const glm::vec3& p : to.positions)
      if (!finite(p)) {
        import_.warn("some positions are not finite; their triangles will be dropped");
        break;
      }
    readNormals(from, used, positions->count(), to);
    readTangents(from, used, positions->count(), to);
    const std::array<int, 2> sets =
        from.material >= 0 ? import_.materialUvSets[from.material] : std::array<int, 2>{0, -1};
    readUvs(from, sets[0], used, positions->count(), to.uv0);
    readUvs(from, sets[1], used, positions->count(), to.uv1);
    readColors(from, used, positions->count(), to);
    importInfluences(
        import_, [&](const std::string& name) { return attribute(from, name, 4, 4); }, used, positions->count(), place_,
        to);
    importTargets(import_, used, positions->count(), place_, to);
    return true;
  }

  void readNormals(const tinygltf::Primitive& from, const std::vector<uint32_t>& used, uint64_t vertices,
                   Primitive& to) {
    const auto normals = attribute(from, "NORMAL", 3, 3);
    if (!normals) return;
    sameCount(*normals, vertices, "NORMAL");
    to.normals.reserve(used.size());
    std::vector<char> broken(used.size(), 0);
    bool any = false;
    for (uint32_t i : used) {
      glm::vec3 n(normals->value(i, 0), normals->value(i, 1), normals->value(i, 2));
      if (!normalise(n)) {
        n = glm::vec3(0.0f);
        broken[to.normals.size()] = 1;
        any = true;
      }
      to.normals.push_back(n);
    }
    if (!any) return;
    import_.warn("some normals have no direction; those of the triangles around them are used");
    std::vector<glm::dvec3> sums(used.size(), glm::dvec3(0.0));
    for (size_t t = 0; t + 2 < to.indices.size(); t += 3) {
      const glm::dvec3 a(to.positions[to.indices[t]]), b(to.positions[to.indices[t + 1]]),
          c(to.positions[to.indices[t + 2]]);
      const glm::dvec3 face = glm::cross(b - a, c - a);
      if (!std::isfinite(face.x + face.y + face.z)) continue;
      for (size_t k = t; k < t + 3; ++k) sums[to.indices[k]] += face;
    }
    for (size_t i = 0; i < used.size(); ++i) {
      if (!broken[i]) continue;
      const double length = glm::length(sums[i]);
      to.normals[i] = length > 0.0 ? glm::vec3(sums[i] / length) : glm::vec3(0.0f, 0.0f, 1.0f);
    }
  }

  void readTangents(const tinygltf::Primitive& from, const std::vector<uint32_t>& used, uint64_t vertices,
                    Primitive& to) {
    const auto tangents = attribute(from, "TANGENT", 4, 4);
    if (!tangents || to.normals.empty()) return;  // without normals the specification says to ignore them
    sameCount(*tangents, vertices, "TANGENT");
    to.tangents.reserve(used.size());
    for (uint32_t i : used) {
      glm::vec3 t(tangents->value(i, 0), tangents->value(i, 1), tangents->value(i, 2));
      if (!normalise(t)) {
        import_.warn("some tangents have no direction; all of their primitive are computed anew");
        to.tangents.clear();
        return;
      }
      to.tangents.emplace_back(t, tangents->value(i, 3) < 0.0f ? -1.0f : 1.0f);
    }
  }

  void readUvs(const tinygltf::Primitive& from, int set, const std::vector<uint32_t>& used, uint64_t vertices,
               std::vector<glm::vec2>& to) {
    const std::string name = "TEXCOORD_" + std::to_string(set);
    const auto uvs = attribute(from, name, 2, 2);
    if (!uvs) return;
    sameCount(*uvs, vertices, name.c_str());
    to.reserve(used.size());
    for (uint32_t i : used) {
      glm::vec2 uv(uvs->value(i, 0), uvs->value(i, 1));
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
        import_.warn("some texture coordinates are not finite and taken as 0");
        uv = glm::vec2(0.0f);
      }
      to.push_back(uv);
    }
  }

  void readColors(const tinygltf::Primitive& from, const std::vector<uint32_t>& used, uint64_t vertices,
                  Primitive& to) {
    const auto colors = attribute(from, "COLOR_0", 3, 4);
    if (!colors) return;
    sameCount(*colors, vertices, "COLOR_0");
    to.colors.reserve(used.size());
    bool white = true;
    for (uint32_t i : used) {
      glm::vec4 color(1.0f);
      for (int c = 0; c < colors->components(); ++c) color[c] = colors->value(i, c);
      for (int c = 0; c < 4; ++c)
        if (!(color[c] >= 0.0f && color[c] <= 1.0f)) {
          import_.warn("vertex colours outside of 0 to 1 are clamped");
          color[c] = color[c] > 0.0f ? 1.0f : 0.0f;
        }
      white = white && color == glm::vec4(1.0f);
      to.colors.push_back(color);
    }
    if (white) to.colors.clear();  // says nothing, and would cost every lookup of the scene
  }

  GltfImport& import_;
  std::string place_;
  const nlohmann::json* json_ = nullptr;  // of the primitive at hand, as is
  std::optional<DracoGeometry> draco_;    // what it holds compressed
  uint64_t triangles_ = 0;
  std::vector<uint32_t> remap_;
};

}  // namespace

void importMeshes(GltfImport& import) {
  MeshImport(import).run();
}

}  // namespace weir::scene
