// Errors with their right place, includes, stages and reflection.
#include <gtest/gtest.h>
#include <weir/shader/compiler.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "support/device.h"

namespace weir::shader {
namespace {

using test::TemporaryFolder;

const std::string kEmptyMain = "void main() {}\n";

std::string errorOf(const CompileRequest& request) {
  try {
    Compiler("-").compile(request);
  } catch (const CompileError& error) {
    return error.what();
  }
  return "it compiled";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Compiler, WorksWithAndWithoutAVersionLine) {
  for (const char* version : {"", "#version 460\n"}) {
    const Module module = Compiler("-").compile({.name = "t", .source = version + kEmptyMain});
    ASSERT_GT(module.spirv.size(), 5u);
    EXPECT_EQ(module.spirv[0], 0x07230203u);
    EXPECT_EQ(module.spirv[1], 0x00010600u) << "SPIR-V 1.6";
    EXPECT_FALSE(module.fromCache);
  }
}

TEST(Compiler, ErrorHasFileAndLine) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/pass.glsl";
  for (const char* version : {"//", "#version 460"}) {
    const std::string source = std::string(version) + "\nvoid main() {\n  float x = nonsense;\n}\n";
    EXPECT_TRUE(contains(errorOf({.name = path, .source = source}), path + ":3: 'nonsense'"));
  }
}

TEST(Compiler, EveryErrorIsListed) {
  const std::string text =
      errorOf({.name = "t.glsl", .source = "void main() {\n  a = 1;\n  b = 2;\n  vec3 c = vec2(0);\n}\n"});
  EXPECT_TRUE(contains(text, "t.glsl:2: 'a'")) << text;
  EXPECT_TRUE(contains(text, "t.glsl:3: 'b'")) << text;
  EXPECT_TRUE(contains(text, "t.glsl:4: ")) << text;
  EXPECT_EQ(std::ranges::count(text, '\n'), 2) << "something beside the three errors: " << text;
}

TEST(Compiler, ErrorInAnIncludeNamesTheInclude) {
  const TemporaryFolder folder;
  const std::string inner = folder.write("common/inner.glsl", "// one\n// two\nfloat f() { return missing; }\n");
  folder.write("common/outer.glsl", "#include \"inner.glsl\"\n");
  const CompileRequest request{.name = folder.path() + "/pass.glsl",
                               .source = "\n#include \"common/outer.glsl\"\n" + kEmptyMain};
  EXPECT_TRUE(contains(errorOf(request), inner + ":3: 'missing'")) << errorOf(request);
}

TEST(Compiler, LineIsRightAfterAnInclude) {
  const TemporaryFolder folder;
  folder.write("a.glsl", "int a() {\n  return 1;\n}\n\n\n");
  const std::string path = folder.path() + "/pass.glsl";
  const std::string text =
      errorOf({.name = path,
               .source = "#include \"a.glsl\"\n#include \"a2.glsl\"\nvoid main() {\n  wrong = a();\n}\n",
               .virtualFiles = {{"a2.glsl", "\n\n\n"}}});
  EXPECT_TRUE(contains(text, path + ":4: 'wrong'")) << text;
}

TEST(Compiler, ErrorInAVirtualFileNamesIt) {
  const std::string text = errorOf({.name = "t",
                                    .source = "#include \"weir/ports\"\n" + kEmptyMain,
                                    .virtualFiles = {{"weir/ports", "\nnonsense here;\n"}}});
  EXPECT_TRUE(contains(text, "weir/ports:2: ")) << text;
}

TEST(Compiler, MissingIncludeSaysWhereItLooked) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/pass.glsl";
  const std::string text = errorOf({.name = path,
                                    .source = "\n#include \"nowhere.glsl\"\n" + kEmptyMain,
                                    .includeFolders = {folder.path() + "/one", folder.path() + "/two"}});
  EXPECT_TRUE(contains(text, path + ":2: ")) << text;
  EXPECT_TRUE(contains(text, folder.path() + "/nowhere.glsl")) << text;
  EXPECT_TRUE(contains(text, folder.path() + "/one/nowhere.glsl")) << text;
  EXPECT_TRUE(contains(text, folder.path() + "/two/nowhere.glsl")) << text;
  // A folder of that name is no file.
  std::filesystem::create_directory(folder.path() + "/nowhere.glsl");
  EXPECT_TRUE(contains(errorOf({.name = path, .source = "#include \"nowhere.glsl\"\n" + kEmptyMain}), "no such file"));
}

TEST(Compiler, MissingIncludeThatIsSwitchedOffIsFine) {
  EXPECT_NO_THROW(
      Compiler("-").compile({.name = "t", .source = "#ifdef NEVER\n#include \"nowhere\"\n#endif\n" + kEmptyMain}));
}

TEST(Compiler, IncludeCycleIsAnError) {
  const TemporaryFolder folder;
  const std::string a = folder.write("a.glsl", "#include \"b.glsl\"\n");
  const std::string b = folder.write("b.glsl", "// first\n#include \"a.glsl\"\n");
  const std::string text =
      errorOf({.name = folder.path() + "/pass.glsl", .source = "#include \"a.glsl\"\n" + kEmptyMain});
  EXPECT_TRUE(contains(text, b + ":2: ")) << text;
  EXPECT_TRUE(contains(text, "includes itself")) << text;
  EXPECT_TRUE(contains(text, a + " > " + b + " > " + a)) << text;
}

TEST(Compiler, TooDeepAnIncludeIsAnError) {
  CompileRequest request{.name = "t", .source = "#include \"0\"\n" + kEmptyMain};
  for (int i = 0; i < 200; ++i)
    request.virtualFiles[std::to_string(i)] = "#include \"" + std::to_string(i + 1) + "\"\n";
  request.virtualFiles["200"] = "";
  EXPECT_TRUE(contains(errorOf(request), "nested deeper than")) << errorOf(request);
}

TEST(Compiler, LooksInOwnFolderThenInFoldersInOrderAndVirtualFilesWin) {
  const TemporaryFolder folder;
  folder.write("own/x.glsl", "const int kX = 1;\n");
  folder.write("one/x.glsl", "const int kX = 2;\n");
  folder.write("two/x.glsl", "const int kX = 3;\n");
  const auto value = [&](const std::string& name, bool isVirtual, const std::string& quoted) {
    CompileRequest request{.name = name,
                           .source = "#include " + quoted + "\nint a[kX == WANTED ? 1 : -1];\n" + kEmptyMain,
                           .includeFolders = {folder.path() + "/one", folder.path() + "/two"}};
    if (isVirtual) request.virtualFiles["x.glsl"] = "const int kX = 4;\n";
    for (int i = 1; i <= 4; ++i) {
      request.defines = {{"WANTED", std::to_string(i)}};
      if (errorOf(request) == "it compiled") return i;
    }
    return 0;
  };
  const std::string own = folder.path() + "/own/pass.glsl";
  EXPECT_EQ(value(own, false, "\"x.glsl\""), 1);
  EXPECT_EQ(value("a text", false, "\"x.glsl\""), 2);
  EXPECT_EQ(value(own, false, "<x.glsl>"), 2);
  EXPECT_EQ(value(own, true, "\"x.glsl\""), 4);
}

TEST(Compiler, PragmaOnceIncludesOnce) {
  const CompileRequest request{.name = "t",
                               .source = "#include \"x\"\n#include \"x\"\n" + kEmptyMain,
                               .virtualFiles = {{"x", "#pragma once\nconst int kX = 1;\n"}}};
  EXPECT_EQ(errorOf(request), "it compiled");
}

TEST(Compiler, ReportsWhatWasIncluded) {
  const TemporaryFolder folder;
  const std::string b = folder.write("b.glsl", "");
  const std::string a = folder.write("a.glsl", "#include \"b.glsl\"\n");
  const Module module = Compiler("-").compile({.name = folder.path() + "/pass.glsl",
                                               .source = "#include \"a.glsl\"\n#include \"v\"\n" + kEmptyMain,
                                               .virtualFiles = {{"v", ""}}});
  EXPECT_EQ(module.files, (std::vector<std::string>{a, b}));
}

TEST(Compiler, EveryStageCompiles) {
  const std::string ray = "#extension GL_EXT_ray_tracing : require\n";
  const std::string payload = "layout(location = 0) rayPayloadInEXT vec4 p;\n";
  const std::pair<Stage, std::string> sources[] = {
      {Stage::Compute, "layout(local_size_x = 64) in;\n" + kEmptyMain},
      {Stage::RayGeneration, ray + kEmptyMain},
      {Stage::ClosestHit, ray + payload + "void main() { p = vec4(gl_HitTEXT); }\n"},
      {Stage::AnyHit, ray + payload + "void main() { ignoreIntersectionEXT; }\n"},
      {Stage::Miss, ray + payload + "void main() { p = vec4(0); }\n"},
      {Stage::Vertex, "void main() { gl_Position = vec4(0); }\n"},
      {Stage::Fragment, "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n"},
      {Stage::Compute,
       "#extension GL_EXT_ray_query : require\n#extension GL_EXT_buffer_reference2 : require\n"
       "#extension GL_EXT_scalar_block_layout : require\n"
       "layout(set = 0, binding = 0) uniform accelerationStructureEXT scene;\n"
       "layout(buffer_reference, scalar) buffer V { vec3 v[]; };\n"
       "layout(push_constant) uniform P { V v; };\n"
       "void main() { rayQueryEXT q; rayQueryInitializeEXT(q, scene, 0, 255, v.v[0], 0.0, v.v[1], 1.0);\n"
       "  rayQueryProceedEXT(q); }\n"},
  };
  for (const auto& [stage, source] : sources) {
    EXPECT_EQ(errorOf({.name = "t", .source = source, .stage = stage}), "it compiled") << source;
  }
}

TEST(Compiler, RefusesWhatIsNoShader) {
  EXPECT_NE(errorOf({.name = "t", .source = ""}), "it compiled");
  EXPECT_NE(errorOf({.name = "t", .source = "int x;\n"}), "it compiled") << "no main";
  EXPECT_NE(errorOf({.name = "t", .source = std::string(1000, '{')}), "it compiled");
  EXPECT_NE(errorOf({.name = "t", .source = std::string("void main() {\0 }", 16)}), "it compiled");
  EXPECT_TRUE(contains(errorOf({.name = "t", .source = "#version 100\nvoid main() {}\n"}), "t:"));
}

TEST(ReadFile, ReadsOrSaysWhich) {
  const TemporaryFolder folder;
  EXPECT_EQ(readFile(folder.write("x", "text\n")), "text\n");
  EXPECT_EQ(readFile(folder.write("empty", "")), "");
  for (const std::string& path : {folder.path(), folder.path() + "/none", std::string("/dev/null")}) {
    try {
      readFile(path);
      FAIL() << path;
    } catch (const InputError& error) {
      EXPECT_TRUE(contains(error.what(), path));
    }
  }
}

TEST(Reflect, GivesSetBindingAndStride) {
  const std::vector<BufferBlock> blocks =
      reflectBuffers({.name = "t",
                      .source = "#extension GL_EXT_scalar_block_layout : require\n"
                                "struct R { vec3 a; uint b; vec2 c; };\n"
                                "layout(set = 1, binding = 3, scalar) buffer Reservoirs { uint count; R r[]; };\n"
                                "layout(set = 1, binding = 4, std430) readonly buffer Padded { R p[]; };\n"
                                "layout(set = 2, binding = 0, scalar) buffer Fixed { R one; } fixedOnes[4];\n"
                                "layout(set = 0, binding = 0) uniform U { vec4 u; };\n"
                                "void main() { r[0] = p[0]; fixedOnes[1].one.a = u.xyz; }\n"});
  ASSERT_EQ(blocks.size(), 3u);
  const auto find = [&](const std::string& name) {
    const auto found = std::ranges::find(blocks, name, &BufferBlock::name);
    return found == blocks.end() ? BufferBlock{} : *found;
  };
  EXPECT_EQ(find("Reservoirs").set, 1u);
  EXPECT_EQ(find("Reservoirs").binding, 3u);
  EXPECT_EQ(find("Reservoirs").arrayStride, 24u);
  EXPECT_EQ(find("Padded").binding, 4u);
  EXPECT_EQ(find("Padded").arrayStride, 32u);
  EXPECT_EQ(find("Fixed").set, 2u);
  EXPECT_EQ(find("Fixed").arrayStride, 0u);
}

TEST(Compiler, ThreadsMayCompileAtOnce) {
  const TemporaryFolder folder;
  Compiler compiler(folder.path() + "/cache");
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&compiler, t] {
      for (int i = 0; i < 10; ++i) {
        // Half of them the same in every thread, so that they race for one cache entry.
        const std::string value = std::to_string(i % 2 ? i : 100 * t + i);
        const CompileRequest good{.name = "t", .source = "const int k = N;\n" + kEmptyMain, .defines = {{"N", value}}};
        EXPECT_FALSE(compiler.compile(good).spirv.empty());
        const CompileRequest bad{.name = "bad" + value, .source = "\nwrong\n"};
        try {
          compiler.compile(bad);
          ADD_FAILURE() << "it compiled";
        } catch (const CompileError& error) {
          EXPECT_TRUE(contains(error.what(), "bad" + value + ":")) << error.what();
        }
      }
    });
  }
}

}  // namespace
}  // namespace weir::shader
