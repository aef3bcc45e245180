// Vector code is chosen at run time: tests run it in every form that this machine can, from plain SSE2 on.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace scumble::testing {

// From the best to the least: that is the one which code may use without asking the processor, HWY_SCALAR or HWY_EMU128
// (later versions of Highway have the SSE2 of every x86-64 instead).
inline std::vector<std::int64_t> InstructionSets() {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  EXPECT_EQ(targets.back(), HWY_STATIC_TARGET) << hwy::TargetName(targets.back());
#if defined(__x86_64__)
  // Whatever Highway calls them, a processor that has AVX2 must have been tried with it and without.
  if (__builtin_cpu_supports("avx2") && HWY_STATIC_TARGET > HWY_AVX2) {  // not a build for such processors alone
    EXPECT_GT(targets.back(), HWY_AVX2) << "better ones have lower bits";
    const auto has_avx2 = [](std::int64_t target) { return target == HWY_AVX2; };
    EXPECT_TRUE(std::any_of(targets.begin(), targets.end(), has_avx2));
  }
#endif
  return targets;
}

template <class Check>
void OnInstructionSet(std::int64_t target, const Check& check) {
  SCOPED_TRACE(hwy::TargetName(target));
  hwy::SetSupportedTargetsForTest(target);
  check();
  hwy::SetSupportedTargetsForTest(0);
}

template <class Check>
void OnTheLeastInstructionSet(const Check& check) {
  OnInstructionSet(InstructionSets().back(), check);
}

template <class Check>
void OnEveryInstructionSet(const Check& check) {
  for (const std::int64_t target : InstructionSets()) OnInstructionSet(target, check);
}

}  // namespace scumble::testing
