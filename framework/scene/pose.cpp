#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/scene/pose.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace weir::scene {
namespace {

glm::dmat4 localMatrix(const Node& node) {
  if (node.matrix) return *node.matrix;
  glm::dmat4 m = glm::mat4_cast(node.rotation);
  for (int i = 0; i < 3; ++i) m[i] *= node.scale[i];
  m[3] = glm::dvec4(node.translation, 1.0);
  return m;
}

/// Calls `visit(node)` for all nodes, parents before their children; files may store them in any order.
template <typename F>
void fromTheRoots(const std::vector<Node>& nodes, F&& visit) {
  std::vector<char> done(nodes.size(), 0);
  std::vector<int> way;
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (int at = static_cast<int>(i); at >= 0 && !done[at]; at = nodes[at].parent) way.push_back(at);
    for (; !way.empty(); way.pop_back()) {
      visit(way.back());
      done[way.back()] = 1;
    }
  }
}

std::vector<glm::dmat4> worldMatrices(const std::vector<Node>& nodes) {
  std::vector<glm::dmat4> world(nodes.size());
  fromTheRoots(nodes, [&](int i) {
    const glm::dmat4 local = localMatrix(nodes[i]);
    world[i] = nodes[i].parent < 0 ? local : world[nodes[i].parent] * local;
  });
  return world;
}

glm::dquat unit(const glm::dquat& q) {
  const double length = std::sqrt(glm::dot(q, q));
  return length > 0.0 ? q / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
}

/// Appendix C.4: the shorter way round, and linear where the angle vanishes.
glm::dquat slerp(const glm::dquat& a, glm::dquat b, double t) {
  if (glm::dot(a, b) < 0.0) b = -b;
  // The arc tangent keeps its digits where the arc cosine loses them.
  const glm::dquat sum = a + b, difference = a - b;
  const double angle = 2.0 * std::atan2(std::sqrt(glm::dot(difference, difference)), std::sqrt(glm::dot(sum, sum)));
  const double sine = std::sin(angle);
  if (!(sine > 0.0)) return a;
  return unit(a * (std::sin((1.0 - t) * angle) / sine) + b * (std::sin(t * angle) / sine));
}

glm::dvec3 vec3Of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

bool isRotation(const Channel& channel) {
  return channel.path == AnimatedPath::Rotation;
}

}  // namespace

std::vector<double> sample(const Channel& channel, double seconds) {
  const std::vector<float>& times = channel.times;
  const size_t width = channel.width;
  const bool cubic = channel.interpolation == Interpolation::CubicSpline;
  const size_t stride = cubic ? 3 * width : width;
  const auto key = [&](size_t k, size_t part) {
    const float* at = channel.values.data() + k * stride + (cubic ? part * width : 0);
    return std::vector<double>(at, at + width);
  };
  const auto normalised = [&](std::vector<double> v) {
    if (!isRotation(channel)) return v;
    const glm::dquat q = unit(glm::dquat(v[3], v[0], v[1], v[2]));
    return std::vector<double>{q.x, q.y, q.z, q.w};
  };

  const auto above = std::upper_bound(times.begin(), times.end(), seconds);
  if (above == times.begin()) return normalised(key(0, 1));
  const size_t k = static_cast<size_t>(above - times.begin()) - 1;
  if (above == times.end() || channel.interpolation == Interpolation::Step) return normalised(key(k, 1));

  const double span = static_cast<double>(times[k + 1]) - times[k], t = (seconds - times[k]) / span;
  const std::vector<double> a = key(k, 1), b = key(k + 1, 1);
  std::vector<double> result(width);
  if (cubic) {
    // Appendix C.5: Hermite with tangents a second, so times the span.
    const std::vector<double> out = key(k, 2), in = key(k + 1, 0);
    const double t2 = t * t, t3 = t2 * t;
    for (size_t i = 0; i < width; ++i)
      result[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * out[i] + (-2 * t3 + 3 * t2) * b[i] +
                  span * (t3 - t2) * in[i];
    return normalised(result);
  }
  if (isRotation(channel)) {
    const glm::dquat q = slerp(unit(glm::dquat(a[3], a[0], a[1], a[2])), unit(glm::dquat(b[3], b[0], b[1], b[2])), t);
    return {q.x, q.y, q.z, q.w};
  }
  for (size_t i = 0; i < width; ++i) result[i] = a[i] + t * (b[i] - a[i]);
  return result;
}

Pose restPose(const Scene& scene) {
  Pose pose;
  pose.world = worldMatrices(scene.nodes);
  for (const Node& node : scene.nodes) pose.weights.push_back(node.weights);
  return pose;
}

Pose evaluate(const Scene& scene, const Clip& clip, double seconds) {
  std::vector<Node> nodes = scene.nodes;
  for (const Channel& channel : clip.channels) {
    Node& node = nodes[channel.node];
    const std::vector<double> value = sample(channel, seconds);
    switch (channel.path) {
      case AnimatedPath::Translation:
        node.translation = vec3Of(value);
        break;
      case AnimatedPath::Rotation:
        node.rotation = glm::dquat(value[3], value[0], value[1], value[2]);
        break;
      case AnimatedPath::Scale:
        node.scale = vec3Of(value);
        break;
      case AnimatedPath::Weights:
        node.weights.assign(value.begin(), value.end());
        break;
    }
  }
  Pose pose;
  pose.world = worldMatrices(nodes);
  for (Node& node : nodes) pose.weights.push_back(std::move(node.weights));
  return pose;
}

std::vector<glm::mat4> jointMatrices(const Skin& skin, const Pose& pose) {
  std::vector<glm::mat4> result;
  for (size_t j = 0; j < skin.joints.size(); ++j)
    result.emplace_back(pose.world[skin.joints[j]] * glm::dmat4(skin.inverseBind[j]));
  return result;
}

std::vector<char> movingNodes(const Scene& scene, const Clip& clip) {
  std::vector<char> moving(scene.nodes.size(), 0);
  for (const Channel& channel : clip.channels) moving[channel.node] |= channel.path != AnimatedPath::Weights ? 1 : 0;
  fromTheRoots(scene.nodes, [&](int i) {
    if (scene.nodes[i].parent >= 0) moving[i] |= moving[scene.nodes[i].parent];
  });
  return moving;
}

std::vector<char> morphingNodes(const Scene& scene, const Clip& clip) {
  std::vector<char> morphing(scene.nodes.size(), 0);
  for (const Channel& channel : clip.channels) morphing[channel.node] |= channel.path == AnimatedPath::Weights ? 1 : 0;
  return morphing;
}

bool deforms(const Scene& scene, const Instance& instance, const Primitive& primitive) {
  if (instance.skin >= 0 && primitive.influencesPerVertex > 0) return true;
  if (primitive.targets.empty() || instance.node < 0) return false;
  const std::vector<float>& weights = scene.nodes[instance.node].weights;
  return std::ranges::any_of(weights, [](float w) { return w != 0.0f; });
}

Primitive deformed(const Primitive& primitive, const std::vector<float>& weights, const std::vector<glm::mat4>* joints,
                   bool mirrors) {
  Primitive out = primitive;  // whatever else a vertex has stays with it
  out.positions.clear();
  out.normals.clear();
  out.tangents.clear();
  out.influencesPerVertex = 0;
  out.influences.clear();
  out.targets.clear();
  const size_t count = primitive.positions.size();
  const bool normals = !primitive.normals.empty(), tangents = !primitive.tangents.empty();
  const bool skinned = joints != nullptr && primitive.influencesPerVertex > 0;
  const auto unitOr = [](const glm::dvec3& v, const glm::vec3& otherwise) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
  };
  for (size_t v = 0; v < count; ++v) {
    glm::dvec3 position(primitive.positions[v]);
    glm::dvec3 normal = normals ? glm::dvec3(primitive.normals[v]) : glm::dvec3(0.0);
    glm::dvec3 tangent = tangents ? glm::dvec3(primitive.tangents[v]) : glm::dvec3(0.0);
    for (size_t t = 0; t < primitive.targets.size() && t < weights.size(); ++t) {
      const MorphTarget& target = primitive.targets[t];
      if (!target.positions.empty()) position += static_cast<double>(weights[t]) * glm::dvec3(target.positions[v]);
      if (!target.normals.empty()) normal += static_cast<double>(weights[t]) * glm::dvec3(target.normals[v]);
      if (!target.tangents.empty()) tangent += static_cast<double>(weights[t]) * glm::dvec3(target.tangents[v]);
    }
    if (skinned) {
      glm::dmat4 m(0.0);
      for (uint32_t k = 0; k < primitive.influencesPerVertex; ++k) {
        const Influence& influence = primitive.influences[v * primitive.influencesPerVertex + k];
        m += static_cast<double>(influence.weight) * glm::dmat4((*joints)[influence.joint]);
      }
      position = glm::dvec3(m * glm::dvec4(position, 1.0));
      const glm::dmat3 linear(m);
      normal = glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                          glm::cross(linear[0], linear[1])) *
               normal * (mirrors ? -1.0 : 1.0);
      tangent = linear * tangent;
    }
    out.positions.emplace_back(position);
    if (normals) out.normals.push_back(unitOr(normal, primitive.normals[v]));
    if (tangents) {
      const glm::dvec3 n(out.normals[v]);
      out.tangents.emplace_back(unitOr(tangent - n * glm::dot(n, tangent), glm::vec3(primitive.tangents[v])),
                                mirrors ? -primitive.tangents[v].w : primitive.tangents[v].w);
    }
  }
  if (mirrors)
    for (size_t t = 0; t + 2 < out.indices.size(); t += 3) std::swap(out.indices[t + 1], out.indices[t + 2]);
  return out;
}

glm::vec3 turned(const glm::dmat4& world, const glm::dvec3& way) {
  const glm::dvec3 d = glm::dmat3(world) * way;
  const double length = glm::length(d);
  return glm::vec3(length > 0.0 && std::isfinite(length) ? d / length : way);
}

void place(Camera& camera, const glm::dmat4& world) {
  camera.eye = glm::vec3(world[3]);
  camera.forward = turned(world, {0.0, 0.0, -1.0});
  const glm::dvec3 forward(camera.forward);
  glm::dvec3 up(turned(world, {0.0, 1.0, 0.0}));
  up -= forward * glm::dot(forward, up);
  // A sheared node can fold up onto forward; any orthogonal direction then serves.
  if (!(glm::length(up) > 1e-6))
    up = glm::cross(forward, std::abs(forward.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
  camera.up = glm::vec3(glm::normalize(up));
}

Camera posed(const Camera& camera, const Pose& pose) {
  Camera result = camera;
  if (camera.node >= 0) place(result, pose.world[camera.node]);
  return result;
}

PunctualLight posed(const PunctualLight& light, const Pose& pose) {
  PunctualLight result = light;
  if (light.node < 0) return result;
  result.position = glm::vec3(pose.world[light.node][3]);
  result.direction = turned(pose.world[light.node], {0.0, 0.0, -1.0});
  return result;
}

const Clip& chooseClip(const Scene& scene, const std::string& text) {
  if (scene.clips.empty()) throw InputError(fmt::format("--animate: {} has no animations", scene.path));
  if (text.empty()) return scene.clips.front();
  std::vector<std::string> names;
  for (const Clip& clip : scene.clips) {
    if (clip.name == text) return clip;
    names.push_back(clip.name);
  }
  size_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc() && stop == end && number < scene.clips.size()) return scene.clips[number];
  std::string message = fmt::format("--clip \"{}\": {} has no such clip", text, scene.path);
  if (const std::string near = nearestName(text, names); !near.empty()) {
    message += "; did you mean \"" + near + "\"?";
  } else {
    message += fmt::format("; it has {}:", scene.clips.size());
    for (size_t i = 0; i < names.size() && i < 8; ++i) message += (i ? ", \"" : " \"") + names[i] + "\"";
  }
  throw InputError(message);
}

double wrapped(const Clip& clip, double seconds) {
  return clip.duration > 0.0 ? seconds - clip.duration * std::floor(seconds / clip.duration) : 0.0;
}

}  // namespace weir::scene
