// Means from a stratified sample: a list is cut into strata of equal length, and two places of each are drawn without
// replacement [Cochran 1977, §5.5]. If neighbours in the list are alike, the mean is more certain than with
// unstratified places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scumble {

struct Estimate {
  double mean = 0.0;
  double standard_error = 0.0;  // of the sample; 0 where every place was measured
};

namespace internal {

struct StratifiedSample {
  std::vector<std::size_t> places;  // in the list
  // Sizes, one for each two places; empty: the sample is the whole list, in its order.
  std::vector<std::size_t> strata;
};

// `samples`, rounded up to even, of a list of `count` places, by a hash of the seed; 0, or as many as there are: all.
// O(samples), thread-safe.
StratifiedSample ChooseStratified(std::size_t count, std::size_t samples, std::uint64_t seed);

// The mean over the whole list from one value for each place of the sample. None: 0.
Estimate MeanOf(const StratifiedSample& sample, std::span<const double> values);

}  // namespace internal
}  // namespace scumble
