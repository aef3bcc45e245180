#include "guidegen/load/gltf/materials.h"

#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/gltf/gltf_extras.h"
#include "guidegen/load/gltf/parse.h"

namespace scumble {
namespace {

std::string Label(const char* kind, int index, const std::string& name) {
  return std::string(kind) + " " + std::to_string(index) + (name.empty() ? "" : " '" + Excerpt(name, 80) + "'");
}

TextureWrap WrapFromGltf(int wrap) {
  if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::kClamp;
  if (wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return TextureWrap::kMirror;
  return TextureWrap::kRepeat;
}

// A list of numbers inside an extension; empty if it is absent, too short or not finite.
std::optional<std::vector<double>> Numbers(const tinygltf::Value& object, const std::string& key, std::size_t count) {
  if (!object.Has(key)) return std::nullopt;
  const tinygltf::Value& list = object.Get(key);
  if (list.ArrayLen() != count) return std::nullopt;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const tinygltf::Value& value = list.Get(static_cast<int>(i));
    if (!value.IsNumber() || !std::isfinite(value.GetNumberAsDouble())) return std::nullopt;
    numbers.push_back(value.GetNumberAsDouble());
  }
  return numbers;
}

// KHR_texture_transform. The rotation is counter-clockwise for a viewer of the picture, where v points down. Blender,
// Babylon and three.js do that, while the matrix printed in the extension's text turns clockwise.
glm::mat3 UvTransform(const tinygltf::Value& extension) {
  const auto offset = Numbers(extension, "offset", 2);
  const auto scale = Numbers(extension, "scale", 2);
  double angle = 0.0;
  if (extension.Has("rotation") && extension.Get("rotation").IsNumber()) {
    angle = extension.Get("rotation").GetNumberAsDouble();
  }
  if (!std::isfinite(angle)) angle = 0.0;
  const double c = std::cos(angle), s = std::sin(angle);
  const double su = scale ? (*scale)[0] : 1.0, sv = scale ? (*scale)[1] : 1.0;
  glm::dmat3 matrix(1.0);
  matrix[0] = glm::dvec3(c * su, -s * su, 0.0);
  matrix[1] = glm::dvec3(s * sv, c * sv, 0.0);
  matrix[2] = glm::dvec3(offset ? (*offset)[0] : 0.0, offset ? (*offset)[1] : 0.0, 1.0);
  return glm::mat3(matrix);
}

// The file ending for a picture's first bytes, or empty. glTF allows PNG, JPEG and, by extension, WebP. Neither the
// file's mimeType nor its uri can be relied on.
std::optional<std::string> EndingOf(std::span<const unsigned char> bytes) {
  const auto starts_with = [&](std::size_t at, std::string_view magic) {
    return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
  };
  if (starts_with(0, "\x89PNG")) return ".png";
  if (starts_with(0, "\xFF\xD8\xFF")) return ".jpg";
  if (starts_with(0, "RIFF") && starts_with(8, "WEBP")) return ".webp";
  return std::nullopt;
}

using SharedBytes = std::shared_ptr<const std::vector<unsigned char>>;

// A picture of the file, with everything that its decoding needs after the file is closed.
struct EncodedPicture {
  std::string file;   // the scene's
  std::string label;  // of the picture, and of a material that uses it
  std::string owner;
  int number = 0;
  SharedBytes bytes;             // null: none are kept
  std::filesystem::path beside;  // the file that holds them instead; empty: none
};

// Reads it with a function of its bytes and of a name for messages.
template <class Read>
auto ReadWith(const EncodedPicture& encoded, const Read& read) -> decltype(read({}, "")) {
  std::span<const unsigned char> bytes;
  if (encoded.bytes) bytes = *encoded.bytes;
  std::vector<std::byte> whole;
  if (!encoded.beside.empty()) {
    if (auto file = ReadRegularFile(encoded.beside)) whole = *std::move(file);
    bytes = AsChars(whole);
  }
  if (bytes.empty()) {
    return InputError(encoded.file + ": " + encoded.label + ", used by " + encoded.owner +
                      ", is missing or empty: put it beside the scene, or export to .glb, which holds its pictures");
  }
  const std::optional<std::string> ending = EndingOf(bytes);
  if (!ending) {
    return InputError(encoded.file + ": " + encoded.label + ", used by " + encoded.owner +
                      ", is neither PNG, JPEG nor WebP: export it again");
  }
  // The decoder is chosen by the ending of the name.
  const std::string name = encoded.file + ": image " + std::to_string(encoded.number) + *ending;
  auto result = read(std::as_bytes(bytes), name);
  if (!result) return Error{result.error().kind, result.error().message + " (" + encoded.label + ")"};
  return result;
}

// Keeps each picture once, to be decoded later, and returns indices of Scene::textures.
class TextureLoader {
 public:
  TextureLoader(const tinygltf::Model& model, const std::string& file, Scene& scene, WarningCounter& warnings)
      : model_(model), file_(file), scene_(scene), warnings_(warnings) {
    for (const tinygltf::Buffer& buffer : model.buffers) room_ += buffer.data.size();
  }

  // `Info` is tinygltf's TextureInfo or NormalTextureInfo. An absent texture gives TextureUse with texture -1.
  template <class Info>
  Expected<TextureUse> Use(const Info& info, const std::string& owner) {
    TextureUse use;
    if (info.index < 0) return use;
    if (std::size_t(info.index) >= model_.textures.size()) {
      return InputError(file_ + ": " + owner + " uses texture " + std::to_string(info.index) + ", the file has " +
                        std::to_string(model_.textures.size()) + ": export it again");
    }
    use.uv_set = info.texCoord;
    if (const auto it = info.extensions.find("KHR_texture_transform"); it != info.extensions.end()) {
      use.uv_transform = UvTransform(it->second);
      if (it->second.Has("texCoord") && it->second.Get("texCoord").IsInt()) {
        use.uv_set = it->second.Get("texCoord").GetNumberAsInt();
      }
    }
    if (use.uv_set < 0 || use.uv_set > 1) {
      warnings_.Add("textures on UV sets other than the first two are left out", owner);
      return TextureUse{};
    }
    const tinygltf::Texture& texture = model_.textures[std::size_t(info.index)];
    if (texture.sampler >= 0 && std::size_t(texture.sampler) < model_.samplers.size()) {
      const tinygltf::Sampler& sampler = model_.samplers[std::size_t(texture.sampler)];
      use.wrap_u = WrapFromGltf(sampler.wrapS);
      use.wrap_v = WrapFromGltf(sampler.wrapT);
      use.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    SCUMBLE_ASSIGN(use.texture, PictureOf(texture, owner));
    return use;
  }

 private:
  // Any number of images may name one buffer view, and any number of views one part of a buffer: that part is kept
  // once. Pictures that do not overlap fit into the buffers together.
  Expected<SharedBytes> BytesOf(int view, const std::string& label) {
    SCUMBLE_ASSIGN(const auto bytes, ReadBufferView(model_, file_, view, label));
    SharedBytes& kept = kept_[{bytes.data(), bytes.size()}];
    if (kept) return kept;
    if (bytes.size() > room_) {
      return InputError(file_ + ": " + label + ": the pictures inside the file's buffers have more bytes than the " +
                        "buffers, so they lie on each other; expected each at a place of its own: export it again");
    }
    room_ -= bytes.size();
    kept = std::make_shared<const std::vector<unsigned char>>(bytes.begin(), bytes.end());
    return kept;
  }

  Expected<int> PictureOf(const tinygltf::Texture& texture, const std::string& owner) {
    int source = texture.source;
    if (const auto webp = texture.extensions.find("EXT_texture_webp"); source < 0 && webp != texture.extensions.end()) {
      if (webp->second.Has("source") && webp->second.Get("source").IsInt()) {
        source = webp->second.Get("source").GetNumberAsInt();
      }
    }
    if (source < 0 || std::size_t(source) >= model_.images.size()) {
      return InputError(file_ + ": " + owner +
                        " has a texture without a picture that can be read; expected PNG, JPEG " + "or WebP");
    }
    if (const auto known = loaded_.find(source); known != loaded_.end()) return known->second;
    const tinygltf::Image& image = model_.images[std::size_t(source)];
    EncodedPicture encoded;
    encoded.label = Label("image", source, image.uri.empty() ? image.name : image.uri);
    encoded.owner = owner;
    encoded.file = file_;
    encoded.number = source;
    if (image.bufferView >= 0) {
      SCUMBLE_ASSIGN(encoded.bytes, BytesOf(image.bufferView, encoded.label));
    } else if (!image.image.empty() || image.uri.empty()) {
      encoded.bytes = std::make_shared<const std::vector<unsigned char>>(image.image);
    } else {
      encoded.beside = PictureFile(file_, image.uri);
    }
    auto kept_texture = std::make_shared<EncodedTexture>();
    kept_texture->bytes = encoded.bytes ? encoded.bytes->size() : 0;
    const auto kept = std::make_shared<const EncodedPicture>(std::move(encoded));
    using Bytes = std::span<const std::byte>;
    kept_texture->decode = [kept] {
      return ReadWith(
          *kept, [](Bytes bytes, const std::string& name) { return DecodePicture(bytes, name, Profiles::kIgnore); });
    };
    kept_texture->count_pixels = [kept] {
      if (!kept->beside.empty()) return CountPixels(kept->beside);
      return ReadWith(*kept, [](Bytes bytes, const std::string& name) { return CountPixels(bytes, name); });
    };
    scene_.textures.emplace_back();
    scene_.encoded_textures.push_back(std::move(kept_texture));
    const int index = static_cast<int>(scene_.textures.size()) - 1;
    loaded_[source] = index;
    return index;
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  Scene& scene_;
  WarningCounter& warnings_;
  std::map<int, int> loaded_;
  std::map<std::pair<const unsigned char*, std::size_t>, SharedBytes> kept_;  // by their place in the model
  std::uint64_t room_ = 0;  // bytes of the buffers that no picture has used yet
};

// A factor that the format limits to 0 … 1.
Expected<float> UnitFactor(double value, const char* what, const std::string& where) {
  if (value >= 0.0 && value <= 1.0) return float(value);
  return InputError(where + " has the " + what + " factor " + std::to_string(value) + "; expected 0 … 1");
}

void WarnOfTextureIndex(const std::string& texture, const std::string& owner, WarningCounter& warnings) {
  warnings.Add("textures whose index is missing or below 0 are left out", owner + ", " + texture);
}

// A texture is absent where its key is: one that is there must have an index.
void CheckTextureIndices(const tinygltf::Material& from, const std::string& owner, WarningCounter& warnings) {
  const auto check = [&](const tinygltf::ParameterMap& values, const char* texture) {
    const auto found = values.find(texture);
    if (found != values.end() && found->second.TextureIndex() < 0) WarnOfTextureIndex(texture, owner, warnings);
  };
  check(from.values, "baseColorTexture");
  check(from.values, "metallicRoughnessTexture");
  check(from.additionalValues, "normalTexture");
  check(from.additionalValues, "emissiveTexture");
}

// `name`, `owner`: of the texture and of its material, for the warning.
tinygltf::TextureInfo TextureInExtension(const tinygltf::Value& from, const char* name, const std::string& owner,
                                         WarningCounter& warnings) {
  tinygltf::TextureInfo info;
  if (from.Has("index") && from.Get("index").IsInt()) info.index = from.Get("index").GetNumberAsInt();
  if (info.index < 0) WarnOfTextureIndex(name, owner, warnings);
  if (from.Has("texCoord") && from.Get("texCoord").IsInt()) info.texCoord = from.Get("texCoord").GetNumberAsInt();
  const char* transform = "KHR_texture_transform";
  if (from.Has("extensions") && from.Get("extensions").Has(transform)) {
    info.extensions[transform] = from.Get("extensions").Get(transform);
  }
  return info;
}

// Converts KHR_materials_pbrSpecularGlossiness, the older model, to metallic-roughness as far as possible. Its metals
// have a black diffuse colour and a specular one, which is lost here.
Expected<tinygltf::PbrMetallicRoughness> FromSpecularGlossiness(const tinygltf::Value& extension,
                                                                const std::string& file, const std::string& owner,
                                                                WarningCounter& warnings) {
  const std::string where = file + ": " + owner;
  tinygltf::PbrMetallicRoughness pbr;
  pbr.metallicFactor = 0.0;
  if (extension.Has("diffuseFactor")) {
    const auto factor = Numbers(extension, "diffuseFactor", 4);
    if (!factor) return InputError(where + " has a diffuse factor that is not 4 numbers; export it again");
    pbr.baseColorFactor = *factor;
  }
  if (extension.Has("diffuseTexture")) {
    pbr.baseColorTexture = TextureInExtension(extension.Get("diffuseTexture"), "diffuseTexture", owner, warnings);
  }
  // With a texture the factor is only the maximum, by default a mirror.
  if (extension.Has("specularGlossinessTexture")) return pbr;
  double glossiness = 1.0;
  if (extension.Has("glossinessFactor")) {
    const tinygltf::Value& value = extension.Get("glossinessFactor");
    glossiness = value.IsNumber() ? value.GetNumberAsDouble() : -1.0;
  }
  SCUMBLE_RETURN_IF_ERROR(UnitFactor(glossiness, "glossiness", where));
  pbr.roughnessFactor = 1.0 - glossiness;
  return pbr;
}

// The material that exporters write beside that extension is for programs without it, and can be metallic: it is
// preferred if it has a colour.
Expected<tinygltf::PbrMetallicRoughness> MetallicRoughness(const tinygltf::Material& from, const std::string& file,
                                                           const std::string& owner, WarningCounter& warnings) {
  const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
  const auto extension = from.extensions.find("KHR_materials_pbrSpecularGlossiness");
  const bool has_color = pbr.baseColorTexture.index >= 0 || pbr.baseColorFactor != std::vector<double>(4, 1.0);
  if (extension == from.extensions.end() || has_color) return pbr;
  warnings.Add(
      "of KHR_materials_pbrSpecularGlossiness the diffuse colour is taken, and 1 - glossiness as roughness, but "
      "not the specular colour; where a texture has the glossiness, roughness is 1",
      owner);
  return FromSpecularGlossiness(extension->second, file, owner, warnings);
}

// KHR_materials_emissive_strength: emission above 1, 1 where it is absent.
Expected<double> EmissiveStrength(const tinygltf::Material& from, const std::string& where) {
  const auto extension = from.extensions.find("KHR_materials_emissive_strength");
  if (extension == from.extensions.end() || !extension->second.Has("emissiveStrength")) return 1.0;
  const tinygltf::Value& value = extension->second.Get("emissiveStrength");
  const double strength = value.IsNumber() ? value.GetNumberAsDouble() : -1.0;
  if (strength >= 0.0 && std::isfinite(strength)) return strength;
  return InputError(where + " has an emissive strength that is not a number of 0 or more; export it again");
}

// The material's response to light: metalness and roughness, and its emission.
Status LoadLighting(const tinygltf::Material& from, const std::string& file, const std::string& owner,
                    TextureLoader& textures, Material& material) {
  const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
  const std::string where = file + ": " + owner;
  SCUMBLE_ASSIGN(material.metallic, UnitFactor(pbr.metallicFactor, "metallic", where));
  SCUMBLE_ASSIGN(material.roughness, UnitFactor(pbr.roughnessFactor, "roughness", where));
  SCUMBLE_ASSIGN(material.metallic_roughness_texture, textures.Use(pbr.metallicRoughnessTexture, owner));
  SCUMBLE_ASSIGN(const double strength, EmissiveStrength(from, where));
  for (int c = 0; c < 3 && std::size_t(c) < from.emissiveFactor.size(); ++c) {
    const float value = float(from.emissiveFactor[std::size_t(c)] * strength);
    if (!std::isfinite(value) || value < 0.0f) {
      return InputError(where + " has the emissive factor " + std::to_string(value) + "; expected 0 or more");
    }
    material.emission[c] = value;
  }
  if (material.emission != glm::vec3(0.0f)) {
    SCUMBLE_ASSIGN(material.emission_texture, textures.Use(from.emissiveTexture, owner));
  }
  return Ok();
}

// Extensions that change what is seen, and that nothing here reads.
void WarnOfShading(const tinygltf::Material& from, const std::string& owner, WarningCounter& warnings) {
  if (from.extensions.count("KHR_materials_unlit") > 0) {
    warnings.Add("KHR_materials_unlit is not read: its surfaces are lit", owner);
  }
  const auto transmission = from.extensions.find("KHR_materials_transmission");
  if (transmission == from.extensions.end() || !transmission->second.Has("transmissionFactor")) return;
  const tinygltf::Value& factor = transmission->second.Get("transmissionFactor");
  if (factor.IsNumber() && factor.GetNumberAsDouble() > 0.0) {
    warnings.Add("KHR_materials_transmission is not read: its surfaces are opaque", owner);
  }
}

}  // namespace

Status LoadGltfMaterials(const tinygltf::Model& model, const std::string& file, Scene& scene,
                         WarningCounter& warnings) {
  TextureLoader textures(model, file, scene, warnings);
  UniqueNames names;
  for (std::size_t i = 0; i < model.materials.size(); ++i) {
    tinygltf::Material from = model.materials[i];
    const std::string owner = Label("material", static_cast<int>(i), from.name);
    Material material;
    material.name = names.Take(from.name.empty() ? "material_" + std::to_string(i) : from.name);
    CheckTextureIndices(from, owner, warnings);
    SCUMBLE_ASSIGN(from.pbrMetallicRoughness, MetallicRoughness(from, file, owner, warnings));
    const std::vector<double>& factor = from.pbrMetallicRoughness.baseColorFactor;
    for (int c = 0; c < 4 && std::size_t(c) < factor.size(); ++c) {
      const float value = static_cast<float>(factor[std::size_t(c)]);
      if (!std::isfinite(value) || value < 0.0f) {
        return InputError(file + ": " + owner + " has the base colour factor " + std::to_string(value) +
                          "; expected 0 … 1");
      }
      material.base_color[c] = value;
    }
    SCUMBLE_ASSIGN(material.base_color_texture, textures.Use(from.pbrMetallicRoughness.baseColorTexture, owner));
    SCUMBLE_ASSIGN(material.normal_texture, textures.Use(from.normalTexture, owner));
    material.normal_scale =
        std::isfinite(from.normalTexture.scale) ? static_cast<float>(from.normalTexture.scale) : 1.0f;
    if (const tinygltf::Value* normal = FindExtrasTexture(from.extras, "normal")) {
      SCUMBLE_ASSIGN(material.normal_texture,
                     textures.Use(TextureInExtension(*normal, "normal", owner, warnings), owner));
    }
    if (const tinygltf::Value* bump = FindExtrasTexture(from.extras, "bump")) {
      SCUMBLE_ASSIGN(material.bump.height_texture,
                     textures.Use(TextureInExtension(*bump, "bump", owner, warnings), owner));
    }
    SCUMBLE_RETURN_IF_ERROR(LoadLighting(from, file, owner, textures, material));
    if (from.alphaMode == "MASK") material.alpha_mode = AlphaMode::kMask;
    if (from.alphaMode == "BLEND") material.alpha_mode = AlphaMode::kBlend;
    material.alpha_cutoff = std::isfinite(from.alphaCutoff) ? static_cast<float>(from.alphaCutoff) : 0.5f;
    material.double_sided = from.doubleSided;
    scene.materials.push_back(std::move(material));
  }
  return Ok();
}

void WarnOfUsedMaterials(const tinygltf::Model& model, const Scene& scene, WarningCounter& warnings) {
  const std::vector<bool> used = UsedMaterials(scene);
  for (std::size_t i = 0; i < model.materials.size(); ++i) {
    if (!used[i]) continue;
    const std::string owner = Label("material", static_cast<int>(i), model.materials[i].name);
    WarnOfCutAlpha(scene.materials[i], owner, warnings);
    WarnOfShading(model.materials[i], owner, warnings);
  }
}

}  // namespace scumble
