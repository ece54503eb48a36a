// Nodes: transforms, clips, cameras, lights; and the model as a whole.
#include <weir/core/error.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>

#include "model.h"

namespace weir::oracle {
namespace {

glm::dvec3 vec3Of(const Json& j, const char* key, const glm::dvec3& fallback) {
  if (!j.contains(key)) return fallback;
  return {j[key].at(0).get<double>(), j[key].at(1).get<double>(), j[key].at(2).get<double>()};
}

struct Local {
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
  std::optional<glm::dmat4> matrix;
  std::vector<double> weights;

  glm::dmat4 toParent() const {
    if (matrix) return *matrix;
    const glm::dmat4 place = glm::translate(glm::dmat4(1), translation);
    return glm::scale(place * glm::mat4_cast(rotation), scale);
  }
};

Local localOf(const Json& node) {
  Local l;
  l.translation = vec3Of(node, "translation", l.translation);
  l.scale = vec3Of(node, "scale", l.scale);
  if (node.contains("rotation")) {
    const Json& r = node["rotation"];
    l.rotation = glm::normalize(
        glm::dquat(r.at(3).get<double>(), r.at(0).get<double>(), r.at(1).get<double>(), r.at(2).get<double>()));
  }
  if (node.contains("matrix")) {
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node["matrix"].at(static_cast<size_t>(i));
    l.matrix = m;
  }
  return l;
}

/// One channel's value at a time (glTF 2.0, appendix C).
std::vector<double> valueAt(const Document& document, const Json& sampler, size_t components, double time,
                            bool rotation) {
  const Values times = document.accessor(sampler.at("input")), values = document.accessor(sampler.at("output"));
  const std::string mode = sampler.value("interpolation", "LINEAR");
  const bool cubic = mode == "CUBICSPLINE";
  const size_t perKey = components * (cubic ? 3 : 1);
  if (values.numbers.size() < times.count * perKey) document.fail("animations", "fewer values than keys");
  const auto part = [&](size_t key, size_t which) {  // cubic: 0 in-tangent, 1 value, 2 out-tangent
    const auto* begin = values.numbers.data() + key * perKey + which * components;
    return std::vector<double>(begin, begin + components);
  };
  const size_t value = cubic ? 1 : 0;
  size_t next = 0;
  while (next < times.count && times.at(next, 0) <= time) ++next;
  if (next == 0) return part(0, value);
  if (next == times.count) return part(times.count - 1, value);
  const double dt = times.at(next, 0) - times.at(next - 1, 0), u = (time - times.at(next - 1, 0)) / dt;
  const std::vector<double> a = part(next - 1, value), b = part(next, value);
  std::vector<double> result(components);
  if (mode == "STEP") return a;
  if (cubic) {
    const std::vector<double> out = part(next - 1, 2), in = part(next, 0);
    for (size_t i = 0; i < components; ++i) {
      result[i] = (2 * u * u * u - 3 * u * u + 1) * a[i] + dt * (u * u * u - 2 * u * u + u) * out[i] +
                  (-2 * u * u * u + 3 * u * u) * b[i] + dt * (u * u * u - u * u) * in[i];
    }
    return result;
  }
  if (mode != "LINEAR") document.fail("animations", "unknown interpolation " + mode);
  if (rotation) {
    const glm::dquat q = glm::slerp(glm::normalize(glm::dquat(a[3], a[0], a[1], a[2])),
                                    glm::normalize(glm::dquat(b[3], b[0], b[1], b[2])), u);
    return {q.x, q.y, q.z, q.w};
  }
  for (size_t i = 0; i < components; ++i) result[i] = a[i] + u * (b[i] - a[i]);
  return result;
}

size_t morphTargets(const Json& root, const Json& node) {
  if (!node.contains("mesh")) return 0;
  const Json& primitive = root.at("meshes").at(node["mesh"].get<size_t>()).at("primitives").at(0);
  return primitive.value("targets", Json::array()).size();
}

void applyClip(const Document& document, const Moment& moment, std::vector<Local>& locals) {
  const Json& root = document.json();
  const Json* clip = nullptr;
  if (root.contains("animations"))
    for (const Json& a : root["animations"])
      if (a.value("name", "") == moment.clip) clip = &a;
  if (clip == nullptr) document.fail("animations", "no clip called \"" + moment.clip + "\"");
  for (const Json& channel : clip->at("channels")) {
    const Json& target = channel.at("target");
    if (!target.contains("node")) document.fail("animations", "a channel without a node");
    const size_t node = target["node"];
    Local& l = locals.at(node);
    if (l.matrix) document.fail("animations", "the oracle doesn't animate nodes with a matrix");
    const std::string path = target.at("path");
    const Json& sampler = clip->at("samplers").at(channel.at("sampler").get<size_t>());
    const size_t components = path == "rotation" ? 4 : path == "weights" ? morphTargets(root, root["nodes"][node]) : 3;
    const std::vector<double> v = valueAt(document, sampler, components, moment.seconds, path == "rotation");
    if (path == "translation")
      l.translation = {v[0], v[1], v[2]};
    else if (path == "scale")
      l.scale = {v[0], v[1], v[2]};
    else if (path == "rotation")
      l.rotation = glm::normalize(glm::dquat(v[3], v[0], v[1], v[2]));
    else if (path == "weights")
      l.weights = v;
    else
      document.fail("animations", "unknown path " + path);
  }
}

Camera cameraOf(const Document& document, const Json& node, const glm::dmat4& world) {
  const Json& from = document.json().at("cameras").at(node["camera"].get<size_t>());
  if (from.at("type") != "perspective") document.fail("cameras", "the oracle knows perspective cameras alone");
  Camera camera;
  camera.name = from.value("name", node.value("name", ""));
  camera.eye = world[3];
  camera.forward = glm::normalize(-glm::dvec3(world[2]));
  const glm::dvec3 up(world[1]);
  camera.up = glm::normalize(up - camera.forward * glm::dot(camera.forward, up));
  camera.verticalFov = from.at("perspective").at("yfov");
  return camera;
}

/// KHR_lights_punctual: at the node's origin, towards its -Z.
PunctualLight lightOf(const Document& document, size_t index, const glm::dmat4& world) {
  const Json& from = document.json().at("extensions").at("KHR_lights_punctual").at("lights").at(index);
  PunctualLight light;
  const std::string kind = from.at("type");
  if (kind == "spot")
    light.kind = PunctualLight::Kind::Spot;
  else if (kind == "directional")
    light.kind = PunctualLight::Kind::Directional;
  else if (kind != "point")
    document.fail("KHR_lights_punctual", "unknown type " + kind);
  light.position = world[3];
  light.direction = glm::normalize(-glm::dvec3(world[2]));
  light.intensity = vec3Of(from, "color", glm::dvec3(1)) * from.value("intensity", 1.0);
  if (kind != "directional") light.range = from.value("range", 0.0);
  const Json spot = from.value("spot", Json::object());
  light.innerCone = spot.value("innerConeAngle", light.innerCone);
  light.outerCone = spot.value("outerConeAngle", light.outerCone);
  return light;
}

std::vector<double> numbersOf(const std::string& text) {
  std::vector<double> numbers;
  for (const char* at = text.c_str();;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || !std::isfinite(numbers.back())) return {};
    if (*end == 0) return numbers;
    if (*end != ',') return {};
    at = end + 1;
  }
}

}  // namespace

Pose poseOf(const Document& document, const std::optional<Moment>& moment) {
  const Json& root = document.json();
  const Json nodes = root.value("nodes", Json::array());
  std::vector<Local> locals;
  for (const Json& node : nodes) locals.push_back(localOf(node));
  if (moment) applyClip(document, *moment, locals);
  Pose pose;
  pose.world.assign(nodes.size(), glm::dmat4(1));
  pose.shown.assign(nodes.size(), false);
  for (const Local& l : locals) pose.weights.push_back(l.weights);
  struct Visit {
    size_t node;
    glm::dmat4 parent;
  };
  std::vector<Visit> stack;
  for (const Json& n : root.at("scenes").at(root.value("scene", size_t{0})).value("nodes", Json::array()))
    stack.push_back({n, glm::dmat4(1)});
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    if (pose.shown.at(visit.node)) document.fail("nodes", "a node with two parents or in a ring");
    pose.shown[visit.node] = true;
    pose.world[visit.node] = visit.parent * locals[visit.node].toParent();
    for (const Json& child : nodes[visit.node].value("children", Json::array()))
      stack.push_back({child, pose.world[visit.node]});
  }
  return pose;
}

Model loadModel(const std::string& path, const std::optional<Moment>& moment) {
  const Document document(path);
  Model model;
  try {
    model.materials = loadMaterials(document, model);
    const Pose pose = poseOf(document, moment);
    const Json nodes = document.json().value("nodes", Json::array());
    for (size_t n = 0; n < nodes.size(); ++n) {
      if (!pose.shown[n]) continue;
      if (nodes[n].contains("mesh")) addMesh(document, pose, n, model);
      if (nodes[n].contains("camera")) model.cameras.push_back(cameraOf(document, nodes[n], pose.world[n]));
      const Json extensions = nodes[n].value("extensions", Json::object());
      if (extensions.contains("KHR_lights_punctual"))
        model.lights.push_back(lightOf(document, extensions["KHR_lights_punctual"].at("light"), pose.world[n]));
    }
  } catch (const Json::exception& error) {
    throw InputError(path + ": " + error.what());
  } catch (const std::out_of_range&) {
    throw InputError(path + ": an index is out of range");
  }
  if (model.triangles.empty()) throw InputError(path + ": no triangles");
  model.low = model.high = model.triangles[0].position[0];
  for (const Triangle& t : model.triangles) {
    for (const glm::dvec3& p : t.position) {
      model.low = glm::min(model.low, p);
      model.high = glm::max(model.high, p);
    }
  }
  return model;
}

Camera chooseCamera(const Model& model, const std::string& text) {
  for (const Camera& camera : model.cameras)
    if (text.empty() || camera.name == text) return camera;
  if (text.empty()) throw InputError("the scene has no camera: --camera ex,ey,ez,tx,ty,tz[,vfov]");
  const std::vector<double> n = numbersOf(text);
  if (n.size() != 6 && n.size() != 7)
    throw InputError("--camera " + text + ": neither a camera of the scene nor ex,ey,ez,tx,ty,tz[,vfov]");
  Camera camera;
  camera.eye = {n[0], n[1], n[2]};
  const glm::dvec3 way = glm::dvec3(n[3], n[4], n[5]) - camera.eye;
  const glm::dvec3 side = glm::cross(way, glm::dvec3(0, 1, 0));
  if (!(glm::length(side) > 0)) throw InputError("--camera " + text + ": looks straight up, down or nowhere");
  camera.forward = glm::normalize(way);
  camera.up = glm::normalize(glm::cross(side, way));
  if (n.size() == 7) camera.verticalFov = glm::radians(n[6]);
  if (!(camera.verticalFov > 0 && camera.verticalFov < 3.14159))
    throw InputError("--camera " + text + ": the field of view must lie between 0 and 180 degrees");
  return camera;
}

}  // namespace weir::oracle
