// What moves: node transforms, skins, morph targets and animation clips. tinygltf is given none of these but the nodes
// (scene/gltf_structure.cpp), so they are read from the JSON, whose shape the schema check has verified.
#include <weir/scene/gltf_import.h>

#include <algorithm>
#include <cmath>

namespace weir::scene {
namespace {

Node importNode(GltfImport& import, const tinygltf::Node& from) {
  Node node;
  node.name = from.name;
  if (from.matrix.size() == 16) {
    glm::dmat4 m(1.0);
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = from.matrix[i];
    if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0)
      import.warn("a node's matrix is not affine; its last row is taken as 0 0 0 1");
    m[0][3] = m[1][3] = m[2][3] = 0.0;
    m[3][3] = 1.0;
    node.matrix = m;
    return node;
  }
  if (from.rotation.size() == 4) {
    const glm::dquat q(from.rotation[3], from.rotation[0], from.rotation[1], from.rotation[2]);
    const double length = std::sqrt(glm::dot(q, q));
    if (length > 0.0 && std::isfinite(length))
      node.rotation = q / length;
    else
      import.warn("a node's rotation has no direction and is ignored");
  }
  if (from.scale.size() == 3) node.scale = {from.scale[0], from.scale[1], from.scale[2]};
  if (from.translation.size() == 3) node.translation = {from.translation[0], from.translation[1], from.translation[2]};
  return node;
}

/// How many morph targets a mesh has; the specification says that all of its primitives have as many.
size_t targetsOf(const Mesh& mesh) {
  size_t most = 0;
  for (const Primitive& primitive : mesh.primitives) most = std::max(most, primitive.targets.size());
  return most;
}

class AnimationImport {
 public:
  explicit AnimationImport(GltfImport& import) : import_(import), json_(import.file.json()) {}

  void run() {
    for (const auto& node : import_.model.nodes) import_.scene.nodes.push_back(importNode(import_, node));
    importWeights();
    each("skins", [&](const auto& from, size_t i) { importSkin(from, "/skins/" + std::to_string(i)); });
    each("animations", [&](const auto& from, size_t i) { importClip(from, "/animations/" + std::to_string(i)); });
  }

 private:
  template <typename F>
  void each(const char* key, F&& f) {
    const auto array = json_.find(key);
    if (array == json_.end()) return;
    for (size_t i = 0; i < array->size(); ++i) f((*array)[i], i);
  }

  /// A node's own weights go before its mesh's.
  void importWeights() {
    const auto read = [](const nlohmann::json& from, std::vector<float>& to) {
      const auto found = from.find("weights");
      if (found == from.end()) return;
      for (size_t i = 0; i < to.size() && i < found->size(); ++i) {
        const float weight = (*found)[i].get<float>();
        to[i] = std::isfinite(weight) ? weight : 0.0f;
      }
    };
    each("nodes", [&](const nlohmann::json& from, size_t n) {
      const int mesh = import_.model.nodes[n].mesh;
      if (mesh < 0) return;
      std::vector<float>& weights = import_.scene.nodes[n].weights;
      weights.assign(targetsOf(import_.scene.meshes[mesh]), 0.0f);
      read(json_["meshes"][mesh], weights);
      read(from, weights);
    });
  }

  void importSkin(const nlohmann::json& from, const std::string& place) {
    Skin skin;
    skin.name = from.value("name", "");
    for (const auto& joint : from["joints"]) skin.joints.push_back(joint.get<int>());
    skin.inverseBind.assign(skin.joints.size(), glm::mat4(1.0f));
    if (const auto found = from.find("inverseBindMatrices"); found != from.end()) {
      const AccessorView view(import_, found->get<int>());
      if (view.components() != 16) import_.file.fail(place + "/inverseBindMatrices", "not 4x4 matrices");
      if (view.count() < skin.joints.size())
        import_.file.fail(place + "/inverseBindMatrices", std::to_string(view.count()) + " matrices for " +
                                                              std::to_string(skin.joints.size()) + " joints");
      for (size_t j = 0; j < skin.joints.size(); ++j) {
        for (int i = 0; i < 16; ++i) skin.inverseBind[j][i / 4][i % 4] = finite(view.value(j, i), place);
        // The specification fixes the last row; some exporters leave rounding there.
        for (int c = 0; c < 4; ++c) skin.inverseBind[j][c][3] = c == 3 ? 1.0f : 0.0f;
      }
    }
    import_.countValues(16 * skin.joints.size(), place);
    import_.scene.skins.push_back(std::move(skin));
  }

  float finite(float value, const std::string& place) {
    if (!std::isfinite(value)) import_.file.fail(place, "a number that is not finite");
    return value;
  }

  void importClip(const nlohmann::json& from, const std::string& place) {
    Clip clip;
    clip.name = from.value("name", "");
    if (clip.name.empty()) clip.name = "clip " + std::to_string(import_.scene.clips.size());
    for (size_t c = 0; c < from["channels"].size(); ++c) {
      const auto& channel = from["channels"][c];
      const std::string at = place + "/channels/" + std::to_string(c);
      const size_t sampler = channel["sampler"].get<size_t>();
      if (sampler >= from["samplers"].size())
        import_.file.fail(at + "/sampler", "there is no sampler " + std::to_string(sampler));
      importChannel(channel["target"], from["samplers"][sampler], at, clip);
    }
    for (const Channel& channel : clip.channels)
      clip.duration = std::max(clip.duration, static_cast<double>(channel.times.back()));
    import_.scene.clips.push_back(std::move(clip));
  }

  void importChannel(const nlohmann::json& target, const nlohmann::json& sampler, const std::string& place,
                     Clip& clip) {
    if (!target.contains("node")) return;  // belongs to an extension
    Channel channel;
    channel.node = target["node"].get<int>();
    Node& node = import_.scene.nodes[channel.node];
    const std::string path = target["path"];
    if (path == "translation" || path == "scale") {
      channel.path = path == "scale" ? AnimatedPath::Scale : AnimatedPath::Translation;
      channel.width = 3;
    } else if (path == "rotation") {
      channel.path = AnimatedPath::Rotation;
      channel.width = 4;
    } else if (path == "weights") {
      channel.path = AnimatedPath::Weights;
      channel.width = static_cast<uint32_t>(node.weights.size());
      if (channel.width == 0) {
        import_.warn("an animation of morph weights whose node has no morph targets is ignored");
        return;
      }
    } else {
      import_.warn("an animation of \"" + path.substr(0, 40) + "\" is ignored");
      return;
    }
    if (channel.path != AnimatedPath::Weights && node.matrix) {
      import_.warn(
          "an animated node has a matrix instead of translation, rotation and scale; the animation replaces it");
      node.matrix.reset();
    }
    const std::string interpolation = sampler.value("interpolation", "LINEAR");
    if (interpolation == "STEP")
      channel.interpolation = Interpolation::Step;
    else if (interpolation == "CUBICSPLINE")
      channel.interpolation = Interpolation::CubicSpline;
    else if (interpolation != "LINEAR")
      import_.file.fail(place, "unknown interpolation \"" + interpolation.substr(0, 40) + "\"");
    readKeys(sampler, place, channel);
    clip.channels.push_back(std::move(channel));
  }

  void readKeys(const nlohmann::json& sampler, const std::string& place, Channel& channel) {
    const AccessorView input(import_, sampler["input"].get<int>()), output(import_, sampler["output"].get<int>());
    if (input.components() != 1 || input.componentType() != TINYGLTF_COMPONENT_TYPE_FLOAT)
      import_.file.fail(place, "its sampler's input is not of float scalars");
    const uint64_t keys = input.count();
    const uint64_t wanted = keys * channel.width * (channel.interpolation == Interpolation::CubicSpline ? 3 : 1);
    const uint64_t components = channel.path == AnimatedPath::Weights ? 1 : channel.width;
    if (output.components() != static_cast<int>(components) || output.count() != wanted / components)
      import_.file.fail(place, "its sampler's output has " + std::to_string(output.count()) + " elements of " +
                                   std::to_string(output.components()) + " numbers instead of " +
                                   std::to_string(wanted / components) + " of " + std::to_string(components));
    import_.countValues(keys + wanted, place);
    for (uint64_t k = 0; k < keys; ++k) {
      channel.times.push_back(finite(input.value(k, 0), place));
      if (channel.times.back() < 0.0f || (k > 0 && !(channel.times[k] > channel.times[k - 1])))
        import_.file.fail(place, "its sampler's times do not rise from 0");
    }
    channel.values.reserve(wanted);
    for (uint64_t i = 0; i < output.count(); ++i)
      for (uint64_t c = 0; c < components; ++c)
        channel.values.push_back(finite(output.value(i, static_cast<int>(c)), place));
  }

  GltfImport& import_;
  const nlohmann::json& json_;
};

}  // namespace

void importAnimation(GltfImport& import) {
  AnimationImport(import).run();
}

void importInfluences(GltfImport& import, const AttributeReader& attribute, const std::vector<uint32_t>& used,
                      uint64_t vertices, const std::string& place, Primitive& to) {
  std::vector<std::pair<AccessorView, AccessorView>> sets;
  for (uint32_t s = 0;; ++s) {
    const auto joints = attribute("JOINTS_" + std::to_string(s)), weights = attribute("WEIGHTS_" + std::to_string(s));
    if (!joints || !weights) break;
    for (const auto* view : {&*joints, &*weights})
      if (view->count() != vertices)
        import.file.fail(place + "/attributes/" + (view == &*joints ? "JOINTS_" : "WEIGHTS_") + std::to_string(s),
                         std::to_string(view->count()) + " elements for " + std::to_string(vertices) + " positions");
    sets.emplace_back(*joints, *weights);
  }
  if (sets.empty()) return;
  to.influencesPerVertex = 4 * static_cast<uint32_t>(sets.size());
  import.countValues(uint64_t{8} * sets.size() * used.size(), place);
  to.influences.resize(used.size() * to.influencesPerVertex);
  for (uint32_t s = 0; s < sets.size(); ++s) {
    const auto& [joints, weights] = sets[s];
    for (size_t v = 0; v < used.size(); ++v) {
      for (int k = 0; k < 4; ++k) {
        Influence& influence = to.influences[v * to.influencesPerVertex + 4 * s + static_cast<uint32_t>(k)];
        const float joint = joints.value(used[v], k), weight = weights.value(used[v], k);
        // A share of nothing may name any joint, also one that doesn't exist.
        if (!(weight > 0.0f) || !std::isfinite(weight)) continue;
        if (!(joint >= 0.0f && joint < 65536.0f))
          import.file.fail(place + "/attributes/JOINTS_" + std::to_string(s), "an index that is none");
        influence = {static_cast<uint32_t>(joint), weight};
      }
    }
  }
  for (size_t v = 0; v < used.size(); ++v) {
    Influence* of = &to.influences[v * to.influencesPerVertex];
    double sum = 0.0;
    for (uint32_t k = 0; k < to.influencesPerVertex; ++k) sum += of[k].weight;
    if (sum > 0.0) {
      for (uint32_t k = 0; k < to.influencesPerVertex; ++k) of[k].weight = static_cast<float>(of[k].weight / sum);
    } else {
      import.warn("some vertices hang on no joint; they follow the first");
      of[0] = {0, 1.0f};
    }
  }
}

void importTargets(GltfImport& import, const std::vector<uint32_t>& used, uint64_t vertices, const std::string& place,
                   Primitive& to) {
  const nlohmann::json& from = import.file.json()[nlohmann::json::json_pointer(place)];
  const auto targets = from.find("targets");
  if (targets == from.end()) return;
  for (size_t t = 0; t < targets->size(); ++t) {
    const auto read = [&](const char* name) {
      std::vector<glm::vec3> values;
      const auto found = (*targets)[t].find(name);
      if (found == (*targets)[t].end()) return values;
      const std::string at = place + "/targets/" + std::to_string(t) + "/" + name;
      const AccessorView view(import, found->get<int>());
      if (view.components() != 3 || view.count() != vertices)
        import.file.fail(at, "not three numbers for each of " + std::to_string(vertices) + " positions");
      import.countValues(3 * used.size(), at);
      values.reserve(used.size());
      for (uint32_t v : used) {
        glm::vec3 delta(view.value(v, 0), view.value(v, 1), view.value(v, 2));
        if (!std::isfinite(delta.x + delta.y + delta.z)) {
          import.warn("some displacements of morph targets are not finite and taken as 0");
          delta = glm::vec3(0.0f);
        }
        values.push_back(delta);
      }
      return values;
    };
    MorphTarget target{read("POSITION"), read("NORMAL"), read("TANGENT")};
    if (to.normals.empty()) target.normals.clear();
    if (to.tangents.empty()) target.tangents.clear();
    to.targets.push_back(std::move(target));
  }
}

}  // namespace weir::scene
