// Every field of every struct that host and shader share, in the order of the host's test.
#include "scene.glsl"

void run(uvec2 pixel) {
  if (pixel != uvec2(0u)) return;
  uint n = 0u;
#define PUT(x) out_words[n++].value = (x)
#define PUTF(x) out_words[n++].value = floatBitsToUint(x)
#define PUT3(v) { const vec3 w = (v); PUTF(w.x); PUTF(w.y); PUTF(w.z); }
#define PUT4(v) { const vec4 w = (v); PUTF(w.x); PUTF(w.y); PUTF(w.z); PUTF(w.w); }
  PUT3(vertexPosition(1u));
  const Vertex v = sceneVertices[1];
  PUT(v.normal); PUT(v.tangent); PUTF(v.uv.x); PUTF(v.uv.y);
  const uvec4 t = sceneTriangles[1];
  PUT(t.x); PUT(t.y); PUT(t.z); PUT(t.w);
  const Instance i = sceneInstances[1];
  PUT4(i.column0); PUT4(i.column1); PUT4(i.column2); PUT4(i.column3);
  PUT(i.firstTriangle); PUT(i.opaqueTriangles); PUT(i.flipsWinding); PUT(i.firstDrawn);
  const Material m = sceneMaterials[1];
  PUT4(m.baseColor); PUT3(m.emission); PUTF(m.alphaCutoff); PUTF(m.metallic); PUTF(m.roughness); PUTF(m.normalScale); PUT(m.flags);
  PUT(uint(m.baseColorTexture)); PUT(uint(m.metallicRoughnessTexture)); PUT(uint(m.normalTexture)); PUT(uint(m.emissiveTexture));
  const Light l = sceneLights[1];
  PUT3(l.position); PUT(l.kind); PUT3(l.a); PUT(l.triangle); PUT3(l.b); PUTF(l.area); PUT3(l.radiance); PUTF(l.pdf);
  const AliasCell c = sceneAlias[1];
  PUTF(c.threshold); PUT(c.alias);
  PUT4(camera.origin); PUT4(camera.forward); PUT4(camera.right); PUT4(camera.up);
  PUT4(previousCamera.origin); PUT4(previousCamera.up);
  PUT(frameWidth); PUT(frameHeight); PUT(frameIndex); PUT(frameSeed); PUT(sceneLightCount); PUT(sceneInstanceCount);
  PUTF(sceneDiameter); PUTF(sceneNear); PUTF(sceneLargest);
  PUTF(param_number); PUT(uint(param_whole)); PUT(param_yes ? 1u : 0u); PUT(uint(param_choice));
  PUTF(param_fixedNumber); PUT(uint(param_fixedWhole)); PUT(param_fixedYes ? 1u : 0u); PUT(uint(param_fixedChoice));
  PUTF(param_last);
}
