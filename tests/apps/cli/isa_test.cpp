// `--isa` reproduces the same bytes.
#include <string>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

using CliIsa = CliTest;

// Every machine has SSE2. A file does not depend on threads, and one instruction set gives equal results for any order
// of work: so all bytes are equal, header, subsamples and bounced light included.
TEST_F(CliIsa, OneSetWritesTheSameFileForAnyThreads) {
  const Arguments guidegen = {"guidegen",  Scene("stilllife.glb"),
                              "--isa",     "sse2",
                              "--size",    "96x54",
                              "--aa",      "2",
                              "--samples", "2",
                              "--layers",  "position,luminance,shadow,lpe.full"};
  RunOk(With(guidegen, {"--threads", "1", "-o", "one.exr"}));
  const Expected<GuideSet> guides = ReadGuides(At("one.exr"), {});
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->attributes.at("scumble:isa"), "sse2");
  for (const char* threads : {"2", "3", "7"}) {
    RunOk(With(guidegen, {"--threads", threads, "-o", "more.exr"}));
    EXPECT_TRUE(Bytes("one.exr") == Bytes("more.exr")) << threads << " threads";
  }
}

}  // namespace
}  // namespace scumble
