#include "guidegen/load/gltf/accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/image/check.h"

namespace scumble {
namespace {

// `count` elements of `element_bytes` bytes, `stride` apart; null when the accessor has no data of its own.
struct Block {
  const unsigned char* data = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

int ComponentBytes(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

int ComponentCount(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

template <class T>
T Load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

float LoadComponent(const unsigned char* bytes, int component_type, bool normalized) {
  const auto convert = [&](auto value, float most) {
    const float f = static_cast<float>(value);
    return normalized ? std::max(f / most, -1.0f) : f;
  };
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return convert(Load<std::int8_t>(bytes), 127.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return convert(Load<std::uint8_t>(bytes), 255.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return convert(Load<std::int16_t>(bytes), 32767.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return convert(Load<std::uint16_t>(bytes), 65535.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return convert(Load<std::uint32_t>(bytes), 4294967295.0f);
    default:
      return Load<float>(bytes);
  }
}

std::uint32_t LoadIndex(const unsigned char* bytes, int component_type) {
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return Load<std::uint8_t>(bytes);
  if (component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return Load<std::uint16_t>(bytes);
  return Load<std::uint32_t>(bytes);
}

bool IsIndexType(int component_type) {
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

// One accessor of one file, with its error messages.
class Reader {
 public:
  Reader(const tinygltf::Model& model, const std::string& file, int index, const std::string& what)
      : model_(model), file_(file), index_(index), what_(what) {}

  // For 4 × 4 matrices, which must be floats: their columns have no padding then.
  Status OpenMatrices() {
    SCUMBLE_RETURN_IF_ERROR(OpenAny());
    if (accessor_->type == TINYGLTF_TYPE_MAT4 && accessor_->componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return Ok();
    return Bad("is no list of 4 × 4 matrices of floats");
  }

  Error Bad(const std::string& reason) const {
    return InputError(file_ + ": " + what_ + ": accessor " + std::to_string(index_) + " " + reason +
                      "; the file is corrupt or was cut short, export it again");
  }

  // Scalars and vectors.
  Status Open() {
    SCUMBLE_RETURN_IF_ERROR(OpenAny());
    if (components_ > 4) return Bad("is a matrix, expected a scalar or a vector");
    return Ok();
  }

  const tinygltf::Accessor& accessor() const { return *accessor_; }
  int components() const { return components_; }
  std::size_t element_bytes() const { return std::size_t(components_) * component_bytes_; }
  int component_bytes() const { return component_bytes_; }
  const Block& main() const { return main_; }

  // Elements inside a buffer view.
  struct Extent {
    int view = -1;
    std::size_t offset = 0;
    std::size_t count = 0;
    std::size_t element_bytes = 0;
    bool strided = false;  // by the view's own stride, if it has one
  };

  // Their place inside the view's buffer; sums and products cannot overflow.
  Expected<Block> Slice(const Extent& want) const {
    const std::size_t bytes = want.element_bytes;
    if (want.view < 0 || std::size_t(want.view) >= model_.bufferViews.size()) {
      return Bad("uses buffer view " + std::to_string(want.view) + ", the file has " +
                 std::to_string(model_.bufferViews.size()));
    }
    SCUMBLE_ASSIGN(const std::span<const unsigned char> view, ReadBufferView(model_, file_, want.view, what_));
    const std::size_t view_stride = model_.bufferViews[std::size_t(want.view)].byteStride;
    const std::size_t stride = want.strided && view_stride > 0 ? view_stride : bytes;
    if (stride < bytes) return Bad("has elements longer than the stride of its buffer view");
    if (want.count == 0) return Block{view.data(), stride, 0};
    const std::size_t room = want.offset <= view.size() ? view.size() - want.offset : 0;
    if (bytes > room || want.count - 1 > (room - bytes) / stride) {
      return Bad("needs " + std::to_string(want.count) + " elements of " + std::to_string(bytes) + " bytes from byte " +
                 std::to_string(want.offset) + " of buffer view " + std::to_string(want.view) + ", which has " +
                 std::to_string(view.size()) + " bytes");
    }
    return Block{view.data() + want.offset, stride, want.count};
  }

  // Calls patch(element, bytes of its value) for every element that a sparse accessor replaces.
  template <class Patch>
  Status ForEachSparse(Patch patch) const {
    if (!accessor_->sparse.isSparse) return Ok();
    const auto& sparse = accessor_->sparse;
    if (sparse.count < 0 || std::size_t(sparse.count) > accessor_->count) return Bad("has a wrong sparse count");
    if (!IsIndexType(sparse.indices.componentType)) return Bad("has sparse indices of a wrong type");
    // tinygltf 2.9 itself takes a negative one for 0, as that of the accessor.
    if (std::ptrdiff_t(sparse.indices.byteOffset) < 0 || std::ptrdiff_t(sparse.values.byteOffset) < 0) {
      return Bad("has a negative sparse offset");
    }
    const std::size_t count = std::size_t(sparse.count);
    const std::size_t index_bytes = std::size_t(ComponentBytes(sparse.indices.componentType));
    SCUMBLE_ASSIGN(const Block indices, Slice({.view = sparse.indices.bufferView,
                                               .offset = std::size_t(sparse.indices.byteOffset),
                                               .count = count,
                                               .element_bytes = index_bytes}));
    SCUMBLE_ASSIGN(const Block values, Slice({.view = sparse.values.bufferView,
                                              .offset = std::size_t(sparse.values.byteOffset),
                                              .count = count,
                                              .element_bytes = element_bytes()}));
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t element = LoadIndex(indices.data + i * indices.stride, sparse.indices.componentType);
      if (element >= accessor_->count)
        return Bad("replaces element " + std::to_string(element) + " of " + std::to_string(accessor_->count));
      patch(element, values.data + i * values.stride);
    }
    return Ok();
  }

 private:
  // Checks everything but the values.
  Status OpenAny() {
    if (index_ < 0 || std::size_t(index_) >= model_.accessors.size()) {
      return Bad("does not exist, the file has " + std::to_string(model_.accessors.size()));
    }
    accessor_ = &model_.accessors[std::size_t(index_)];
    components_ = ComponentCount(accessor_->type);
    component_bytes_ = ComponentBytes(accessor_->componentType);
    if (components_ == 0) return Bad("is a matrix, expected a scalar or a vector");
    if (component_bytes_ == 0) {
      return Bad("has the component type " + std::to_string(accessor_->componentType) + ", which glTF does not know");
    }
    if (accessor_->bufferView < 0) {
      if (accessor_->count > kMaxZeroElements) {
        return Bad("has " + std::to_string(accessor_->count) + " elements and no data");
      }
      return Ok();
    }
    SCUMBLE_ASSIGN(main_, Slice({.view = accessor_->bufferView,
                                 .offset = accessor_->byteOffset,
                                 .count = accessor_->count,
                                 .element_bytes = element_bytes(),
                                 .strided = true}));
    return Ok();
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  const int index_;
  const std::string& what_;
  const tinygltf::Accessor* accessor_ = nullptr;
  int components_ = 0;
  int component_bytes_ = 0;
  Block main_;
};

}  // namespace

Expected<std::span<const unsigned char>> ReadBufferView(const tinygltf::Model& model, const std::string& file,
                                                        int buffer_view, const std::string& what) {
  const auto bad = [&](const std::string& reason) {
    return InputError(file + ": " + what + ": buffer view " + std::to_string(buffer_view) + " " + reason +
                      "; the file is corrupt or was cut short, export it again");
  };
  if (buffer_view < 0 || std::size_t(buffer_view) >= model.bufferViews.size()) {
    return bad("does not exist, the file has " + std::to_string(model.bufferViews.size()));
  }
  const tinygltf::BufferView& view = model.bufferViews[std::size_t(buffer_view)];
  if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size()) {
    return bad("is in buffer " + std::to_string(view.buffer) + ", the file has " +
               std::to_string(model.buffers.size()));
  }
  const std::vector<unsigned char>& data = model.buffers[std::size_t(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) {
    return bad("has " + std::to_string(view.byteLength) + " bytes from byte " + std::to_string(view.byteOffset) +
               " of a buffer of " + std::to_string(data.size()) + " bytes");
  }
  return std::span<const unsigned char>(data).subspan(view.byteOffset, view.byteLength);
}

Status ZeroBudget::Take(const tinygltf::Model& model, const std::string& file, int accessor) {
  if (accessor < 0 || std::size_t(accessor) >= model.accessors.size()) return Ok();
  const tinygltf::Accessor& from = model.accessors[std::size_t(accessor)];
  if (from.bufferView >= 0) return Ok();
  constexpr std::uint64_t kElementsOfAValue = 16;
  const std::uint64_t values = from.sparse.isSparse ? std::uint64_t(std::max(from.sparse.count, 0)) : 0;
  const std::uint64_t zeros = from.count - std::min<std::uint64_t>(from.count, kElementsOfAValue * values);
  if (zeros <= limit_ - taken_) {
    taken_ += zeros;
    return Ok();
  }
  const std::uint64_t found = zeros > ~taken_ ? ~std::uint64_t(0) : taken_ + zeros;
  return InputError(file + ": what is read of accessors without data comes to " + std::to_string(found) +
                    " elements with accessor " + std::to_string(accessor) + "; expected at most " +
                    std::to_string(limit_) + ": export it again, with the data");
}

Expected<std::size_t> AccessorCount(const tinygltf::Model& model, const std::string& file, int accessor,
                                    const std::string& what) {
  Reader reader(model, file, accessor, what);
  SCUMBLE_RETURN_IF_ERROR(reader.Open());
  return reader.accessor().count;
}

void ElementChoice::Clear() {
  for (std::uint32_t element : elements_) places_[element] = kNone;
  elements_.clear();
}

std::uint32_t ElementChoice::Add(std::uint32_t element) {
  if (element >= places_.size()) places_.resize(std::size_t(element) + 1, kNone);
  std::uint32_t& place = places_[element];
  if (place == kNone) {
    place = static_cast<std::uint32_t>(elements_.size());
    elements_.push_back(element);
  }
  return place;
}

namespace {

// `reader` is open.
Expected<FloatTable> ReadTable(const Reader& reader, const ElementChoice* choice = nullptr) {
  const int type = reader.accessor().componentType;
  const bool normalized = reader.accessor().normalized;
  FloatTable table;
  table.count = choice ? choice->elements().size() : reader.accessor().count;
  table.components = reader.components();
  table.values.assign(table.count * std::size_t(table.components), 0.0f);
  const auto put = [&](std::size_t row, const unsigned char* bytes) {
    float* out = table.values.data() + row * std::size_t(table.components);
    for (int c = 0; c < table.components; ++c) {
      out[c] = LoadComponent(bytes + c * reader.component_bytes(), type, normalized);
    }
  };
  const Block& block = reader.main();
  if (!choice) {
    for (std::size_t i = 0; i < block.count; ++i) put(i, block.data + i * block.stride);
    SCUMBLE_RETURN_IF_ERROR(reader.ForEachSparse(put));
    return table;
  }
  for (std::size_t row = 0; row < table.count; ++row) {
    const std::size_t element = choice->elements()[row];
    SCUMBLE_DCHECK(element < reader.accessor().count);
    if (block.count > 0) put(row, block.data + element * block.stride);
  }
  SCUMBLE_RETURN_IF_ERROR(reader.ForEachSparse([&](std::size_t element, const unsigned char* bytes) {
    if (const std::uint32_t row = choice->PlaceOf(element); row != ElementChoice::kNone) put(row, bytes);
  }));
  return table;
}

}  // namespace

Expected<FloatTable> ReadFloats(const tinygltf::Model& model, const std::string& file, int accessor,
                                const std::string& what, const ElementChoice* choice) {
  Reader reader(model, file, accessor, what);
  SCUMBLE_RETURN_IF_ERROR(reader.Open());
  return ReadTable(reader, choice);
}

Expected<std::vector<glm::dmat4>> ReadMatrices(const tinygltf::Model& model, const std::string& file, int accessor,
                                               const std::string& what) {
  Reader reader(model, file, accessor, what);
  SCUMBLE_RETURN_IF_ERROR(reader.OpenMatrices());
  SCUMBLE_ASSIGN(const FloatTable table, ReadTable(reader));
  std::vector<glm::dmat4> matrices(table.count);
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    if (!std::isfinite(table.values[i])) {
      return reader.Bad("has NaN or infinity in matrix " + std::to_string(i / 16));
    }
    matrices[i / 16][int(i % 16 / 4)][int(i % 4)] = double(table.values[i]);
  }
  return matrices;
}

Expected<std::vector<std::uint32_t>> ReadIndices(const tinygltf::Model& model, const std::string& file, int accessor,
                                                 std::size_t vertex_count, const std::string& what) {
  Reader reader(model, file, accessor, what);
  SCUMBLE_RETURN_IF_ERROR(reader.Open());
  const int type = reader.accessor().componentType;
  if (reader.components() != 1 || !IsIndexType(type)) return reader.Bad("is not a list of unsigned indices");
  std::vector<std::uint32_t> indices(reader.accessor().count, 0);
  const auto put = [&](std::size_t i, const unsigned char* bytes) { indices[i] = LoadIndex(bytes, type); };
  const Block& block = reader.main();
  for (std::size_t i = 0; i < block.count; ++i) put(i, block.data + i * block.stride);
  SCUMBLE_RETURN_IF_ERROR(reader.ForEachSparse(put));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= vertex_count) {
      return reader.Bad("has the index " + std::to_string(indices[i]) + " at place " + std::to_string(i) +
                        ", but there are only " + std::to_string(vertex_count) + " vertices");
    }
  }
  return indices;
}

}  // namespace scumble
