// Reads glTF accessors, with every offset and count checked against the data in the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/loader_util.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// The values of an accessor as floats: normalized integers are mapped to [0, 1] or [-1, 1], others converted.
struct FloatTable {
  std::size_t count = 0;
  int components = 0;         // 1 … 4
  std::vector<float> values;  // count × components
};

// Throughout, `file` and `what` ("mesh 'Cube', POSITION") are for the messages.

// The declared number of an accessor's elements, after its index and its extent have been checked.
Expected<std::size_t> AccessorCount(const tinygltf::Model& model, const std::string& file, int accessor,
                                    const std::string& what);

// An accessor without a buffer view is all zeros, except for the values of a sparse one. It needs no byte of the file,
// however many elements it has, and may be named any number of times. So its count has a limit, and all readings of
// such accessors share another.
inline constexpr std::uint64_t kMaxZeroElements = 16'000'000;

// Counts elements without a byte in the file; a value of a sparse accessor counts for 16 of them.
class ZeroBudget {
 public:
  explicit ZeroBudget(std::uint64_t limit) : limit_(limit) {}

  // Takes one reading of an accessor from the budget, before it is read. Over the limit: kInput, naming the file. An
  // accessor with data, or one that does not exist, takes nothing.
  Status Take(const tinygltf::Model& model, const std::string& file, int accessor);

 private:
  std::uint64_t limit_;
  std::uint64_t taken_ = 0;
};

// Elements of a list that many readers share, in the order in which they were added. Its cost depends on the elements
// added, except for the first call that reaches further into the list: so one choice serves many readers.
class ElementChoice {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t(0);

  void Clear();
  // Returns the element's place among the chosen ones; a chosen element keeps its place.
  std::uint32_t Add(std::uint32_t element);
  // kNone where it is not among them.
  std::uint32_t PlaceOf(std::size_t element) const { return element < places_.size() ? places_[element] : kNone; }
  std::span<const std::uint32_t> elements() const { return elements_; }

 private:
  std::vector<std::uint32_t> elements_;
  std::vector<std::uint32_t> places_;  // by element, as far as any reached
};

// Scalars and vectors of any component type, strided, sparse, or without data (zeros). Matrices are refused. With a
// choice, whose elements must all exist, the table holds only those, at their places; all values of a sparse accessor
// are still checked.
Expected<FloatTable> ReadFloats(const tinygltf::Model& model, const std::string& file, int accessor,
                                const std::string& what, const ElementChoice* choice = nullptr);

// A list of 4 × 4 matrices of floats, column by column; each value finite.
Expected<std::vector<glm::dmat4>> ReadMatrices(const tinygltf::Model& model, const std::string& file, int accessor,
                                               const std::string& what);

// Unsigned 8-, 16- or 32-bit scalars, each below `vertex_count`.
Expected<std::vector<std::uint32_t>> ReadIndices(const tinygltf::Model& model, const std::string& file, int accessor,
                                                 std::size_t vertex_count, const std::string& what);

// The bytes of a buffer view, for embedded pictures. They live as long as the model.
Expected<std::span<const unsigned char>> ReadBufferView(const tinygltf::Model& model, const std::string& file,
                                                        int buffer_view, const std::string& what);

}  // namespace scumble
