// Reads glTF accessors, with every offset and count checked against the data that is really there.
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

// How many elements an accessor claims to have, once its index and its extent are known to be right.
Expected<std::size_t> AccessorCount(const tinygltf::Model& model, const std::string& file, int accessor,
                                    const std::string& what);

// An accessor without a buffer view is all zeros, but for what a sparse one puts in their place: it needs no byte of
// the file, however many elements it has, and may be named any number of times. So its count has a limit, and what is
// read of such accessors has one for all together.
inline constexpr std::uint64_t kMaxZeroElements = 16'000'000;

// Counts elements that no byte of the file stands for; a value of a sparse accessor stands for 16.
class ZeroBudget {
 public:
  explicit ZeroBudget(std::uint64_t limit) : limit_(limit) {}

  // One more reading of an accessor, before it is read: kInput, naming the file, where it is one too many. Those that
  // have data, or do not exist, take nothing.
  Status Take(const tinygltf::Model& model, const std::string& file, int accessor);

 private:
  std::uint64_t limit_;
  std::uint64_t taken_ = 0;
};

// Elements of a list that many readers share, in the order in which they were added. No call costs more for a longer
// list, but for the first that reaches so far, so one choice serves reader after reader.
class ElementChoice {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t(0);

  void Clear();
  // Its place among the chosen ones; an element that is among them keeps the place that it has.
  std::uint32_t Add(std::uint32_t element);
  // kNone where it is not among them.
  std::uint32_t PlaceOf(std::size_t element) const { return element < places_.size() ? places_[element] : kNone; }
  std::span<const std::uint32_t> elements() const { return elements_; }

 private:
  std::vector<std::uint32_t> elements_;
  std::vector<std::uint32_t> places_;  // by element, as far as any reached
};

// Scalars and vectors of any component type, strided, sparse, or without data (zeros). Matrices are refused. With a
// choice, whose elements must all exist, the table has those alone, at their places; the values of a sparse accessor
// are looked through all the same.
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
