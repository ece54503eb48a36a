// The node hierarchy, multiplied out: instances, lights and cameras in the world.
#include <weir/scene/gltf_import.h>
#include <weir/scene/pose.h>

#include <cmath>
#include <set>
#include <utility>

namespace weir::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;

class NodeImport {
 public:
  explicit NodeImport(GltfImport& import) : import_(import), parent_(import.model.nodes.size(), -1) {}

  void run() {
    checkTree();
    for (size_t i = 0; i < parent_.size(); ++i) import_.scene.nodes[i].parent = parent_[i];
    pose_ = restPose(import_.scene);
    for (const Mesh& mesh : import_.scene.meshes) {
      uint64_t count = 0;
      for (const Primitive& primitive : mesh.primitives) count += primitive.indices.size() / 3;
      meshTriangles_.push_back(count);
    }
    const auto& model = import_.model;
    std::vector<int> roots;
    if (!model.scenes.empty()) {
      const int scene = model.defaultScene >= 0 ? model.defaultScene : 0;
      if (model.scenes.size() > 1) import_.warn("the file has several scenes; the default one is taken");
      roots = model.scenes[scene].nodes;
    } else {
      // Without scenes every tree is shown, as viewers do.
      for (size_t i = 0; i < model.nodes.size(); ++i)
        if (parent_[i] < 0) roots.push_back(static_cast<int>(i));
    }
    std::vector<char> seen(model.nodes.size(), 0);
    for (int root : roots) {
      if (parent_[root] >= 0)
        import_.file.fail("/scenes", "node " + std::to_string(root) + " is no root: it is a child of node " +
                                         std::to_string(parent_[root]));
      if (seen[root]++) import_.file.fail("/scenes", "node " + std::to_string(root) + " is listed twice");
      walk(root);
    }
  }

 private:
  /// Every node has at most one parent; with that, a cycle is a tree without a root, and is caught by walking up.
  void checkTree() {
    const auto& nodes = import_.model.nodes;
    for (size_t i = 0; i < nodes.size(); ++i)
      for (int child : nodes[i].children) {
        if (parent_[child] >= 0)
          import_.file.fail(
              "/nodes/" + std::to_string(i) + "/children",
              "node " + std::to_string(child) + " is already a child of node " + std::to_string(parent_[child]));
        parent_[child] = static_cast<int>(i);
      }
    std::vector<char> state(nodes.size(), 0);  // 1: being walked, 2: known to reach a root
    std::vector<int> way;
    for (size_t i = 0; i < nodes.size(); ++i) {
      way.clear();
      int at = static_cast<int>(i);
      while (at >= 0 && state[at] == 0) {
        state[at] = 1;
        way.push_back(at);
        at = parent_[at];
      }
      if (at >= 0 && state[at] == 1) import_.file.fail("/nodes/" + std::to_string(at), "is its own ancestor");
      for (int node : way) state[node] = 2;
    }
  }

  void walk(int root) {
    struct Visit {
      int node;
      uint32_t depth;
    };
    std::vector<Visit> stack{{root, 1}};
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const auto& node = import_.model.nodes[visit.node];
      const std::string place = "/nodes/" + std::to_string(visit.node);
      if (visit.depth > import_.limits.nodeDepth)
        import_.file.fail(place, "deeper than " + std::to_string(import_.limits.nodeDepth) + " nodes");
      const glm::dmat4& world = pose_.world[visit.node];
      const glm::mat4 rounded(world);
      for (int i = 0; i < 16; ++i)
        if (!std::isfinite(rounded[i / 4][i % 4])) import_.file.fail(place, "its transform is not finite");
      if (node.mesh >= 0) addInstance(visit.node, rounded, place);
      if (node.camera >= 0) addCamera(visit.node, place);
      addLight(visit.node, place);
      // Pushed in reverse, so that instances come out in the file's order.
      for (size_t i = node.children.size(); i-- > 0;) stack.push_back({node.children[i], visit.depth + 1});
    }
  }

  void addInstance(int node, const glm::mat4& toWorld, const std::string& place) {
    const int mesh = import_.model.nodes[node].mesh, skin = import_.model.nodes[node].skin;
    triangles_ += meshTriangles_[mesh];
    if (triangles_ > import_.limits.triangles)
      import_.file.fail(place,
                        "more than " + std::to_string(import_.limits.triangles) + " triangles with all instances");
    if (skin >= 0) checkSkin(mesh, skin, place);
    import_.scene.instances.push_back({mesh, node, toWorld, skin});
  }

  /// Every influence names a joint that the skin has.
  void checkSkin(int mesh, int skin, const std::string& place) {
    const size_t joints = import_.scene.skins[skin].joints.size();
    if (!checkedSkins_.insert({mesh, skin}).second) return;
    for (const Primitive& primitive : import_.scene.meshes[mesh].primitives)
      for (const Influence& influence : primitive.influences)
        if (influence.joint >= joints)
          import_.file.fail(place, "its mesh refers to joint " + std::to_string(influence.joint) + " of skin " +
                                       std::to_string(skin) + ", which has " + std::to_string(joints));
  }

  void addCamera(int index, const std::string& place) {
    const auto& node = import_.model.nodes[index];
    const auto& from = import_.model.cameras[node.camera];
    if (from.type != "perspective") {
      import_.warn("orthographic cameras are left out");
      return;
    }
    if (!(from.perspective.yfov > 0.0 && from.perspective.yfov < kPi))
      import_.file.fail(place, "its camera's yfov is not between 0 and pi");
    Camera camera;
    camera.name = !from.name.empty()   ? from.name
                  : !node.name.empty() ? node.name
                                       : "camera " + std::to_string(import_.scene.cameras.size());
    camera.node = index;
    scene::place(camera, pose_.world[index]);
    camera.verticalFov = static_cast<float>(from.perspective.yfov);
    import_.scene.cameras.push_back(camera);
  }

  void addLight(int at, const std::string& place) {
    const auto& node = import_.model.nodes[at];
    const auto found = node.extensions.find("KHR_lights_punctual");
    if (found == node.extensions.end()) return;
    const int index = found->second.Get("light").GetNumberAsInt();
    if (index < 0 || static_cast<size_t>(index) >= import_.model.lights.size())
      import_.file.fail(place, "there is no light " + std::to_string(index));
    const auto& from = import_.model.lights[index];
    PunctualLight light;
    light.name = from.name;
    if (from.type == "point")
      light.kind = LightKind::Point;
    else if (from.type == "spot")
      light.kind = LightKind::Spot;
    else if (from.type == "directional")
      light.kind = LightKind::Directional;
    else
      import_.file.fail("/extensions/KHR_lights_punctual/lights/" + std::to_string(index),
                        "unknown type \"" + from.type + "\"");
    for (int i = 0; i < 3; ++i)
      light.intensity[i] = static_cast<float>((from.color.size() == 3 ? from.color[i] : 1.0) * from.intensity);
    if (!std::isfinite(light.intensity.x + light.intensity.y + light.intensity.z))
      import_.file.fail(place, "its light's intensity is not finite");
    if (glm::any(glm::lessThan(light.intensity, glm::vec3(0.0f)))) {
      import_.warn("negative light is taken as none");
      light.intensity = glm::max(light.intensity, glm::vec3(0.0f));
    }
    light.node = at;
    light = posed(light, pose_);
    if (light.kind != LightKind::Directional)
      light.range = from.range > 0.0 && from.range < 1e38 ? static_cast<float>(from.range) : 0.0f;
    if (light.kind == LightKind::Spot) {
      double inner = from.spot.innerConeAngle, outer = from.spot.outerConeAngle;
      if (!(inner >= 0.0 && inner < outer && outer <= kPi / 2)) {
        import_.warn("a spot light's cone angles are out of order and clamped");
        outer = std::min(std::max(outer, 0.0), kPi / 2);
        inner = std::min(std::max(inner, 0.0), outer);
      }
      light.innerCone = static_cast<float>(inner);
      light.outerCone = static_cast<float>(outer);
    }
    import_.scene.lights.push_back(light);
  }

  GltfImport& import_;
  std::vector<int> parent_;
  Pose pose_;
  std::vector<uint64_t> meshTriangles_;
  std::set<std::pair<int, int>> checkedSkins_;
  uint64_t triangles_ = 0;
};

}  // namespace

void importNodes(GltfImport& import) {
  NodeImport(import).run();
}

}  // namespace weir::scene
