#include "guidegen/load/gltf/gltf_extras.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "guidegen/cycles_version.h"
#include "guidegen/load/loader_util.h"

namespace scumble {
namespace {

using std::numbers::pi;

constexpr std::size_t kMaxWarnings = 100;
constexpr std::size_t kLongestWarning = 400;   // bytes; export_scene.py writes less
constexpr double kLargestPassIndex = 32767.0;  // Blender's limit

// The object of that name inside extras.scumble, or null.
const tinygltf::Value* Find(const tinygltf::Value& extras, const std::string& key) {
  if (!extras.IsObject() || !extras.Has("scumble")) return nullptr;
  const tinygltf::Value& ours = extras.Get("scumble");
  return ours.IsObject() && ours.Has(key) ? &ours.Get(key) : nullptr;
}

// Takes values out of one object and keeps the first error, so that a reader lists its values line by line.
class Fields {
 public:
  Fields(const tinygltf::Value& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object_.IsObject()) Complain("", "is no object");
  }

  bool Has(const std::string& key) const {
    return object_.IsObject() && object_.Has(key) && object_.Get(key).Type() != tinygltf::NULL_TYPE;
  }
  bool IsTrue(const std::string& key) const {
    return Has(key) && object_.Get(key).IsBool() && object_.Get(key).Get<bool>();
  }
  std::string Text(const std::string& key) {
    if (Has(key) && object_.Get(key).IsString()) return object_.Get(key).Get<std::string>();
    Complain(key, "is no text");
    return {};
  }
  double Number(const std::string& key, double least, double most) {
    if (!Has(key) || !object_.Get(key).IsNumber()) return Complain(key, "is no number"), least;
    const double value = object_.Get(key).GetNumberAsDouble();
    if (!(value >= least && value <= most) || !std::isfinite(value)) {
      return Complain(key, "is " + std::to_string(value)), least;
    }
    return value;
  }
  // Three numbers, none negative.
  glm::vec3 Color(const std::string& key) {
    if (!Has(key)) return Complain(key, "is missing"), glm::vec3(0.0f);
    const tinygltf::Value& list = object_.Get(key);
    if (!list.IsArray() || list.ArrayLen() != 3) return Complain(key, "is no list of 3 numbers"), glm::vec3(0.0f);
    glm::vec3 color(0.0f);
    for (int i = 0; i < 3; ++i) {
      const tinygltf::Value& value = list.Get(i);
      color[i] = value.IsNumber() ? static_cast<float>(value.GetNumberAsDouble()) : -1.0f;
      if (!(color[i] >= 0.0f) || !std::isfinite(color[i])) return Complain(key, "is no colour"), glm::vec3(0.0f);
    }
    return color;
  }
  void Complain(const std::string& key, const std::string& what) {
    if (complaint_.empty()) complaint_ = (key.empty() ? "" : " '" + key + "'") + " " + what;
  }
  Status Verdict() const {
    if (complaint_.empty()) return Ok();
    return InputError(where_ + ": in the extras of scumble," + complaint_ +
                      ": export it again with this version's export_scene.py");
  }

 private:
  const tinygltf::Value& object_;
  std::string where_;
  std::string complaint_;
};

constexpr double kLargest = 1e30;  // finite as a float after every formula here

void ReadSpot(Fields& fields, Light& light) {
  light.cycles_spot = true;
  light.spot_blend = fields.Number("spot_blend", 0.0, 1.0);
  if (fields.Has("cosine")) light.spot_cosine = fields.IsTrue("cosine");
  light.outer_cone_degrees = fields.Number("spot_size", 0.0, pi + 1e-6) / 2.0 * kDegreesPerRadian;
  light.inner_cone_degrees = light.outer_cone_degrees * (1.0 - light.spot_blend);
}

// False if the light has no area, and so emits nothing.
bool ReadArea(Fields& fields, Light& light, double energy) {
  const std::string shape = fields.Text("shape");
  light.ellipse = shape == "DISK" || shape == "ELLIPSE";
  if (!light.ellipse && shape != "SQUARE" && shape != "RECTANGLE") fields.Complain("shape", "is unknown");
  light.size_x = fields.Number("size", 0.0, kLargest);
  light.size_y = fields.Number("size_y", 0.0, kLargest);
  const double area = light.size_x * light.size_y * (light.ellipse ? pi / 4.0 : 1.0);
  light.intensity = energy / (4.0 * area);
  return area > 0.0 && std::isfinite(light.intensity);
}

void ReadPrincipled(Fields& fields, Material& material) {
  if (fields.Has("roughness")) material.roughness = static_cast<float>(fields.Number("roughness", 0.0, 1.0));
  if (fields.Has("metallic")) material.metallic = static_cast<float>(fields.Number("metallic", 0.0, 1.0));
  if (fields.Has("emission")) material.emission = fields.Color("emission");
}

Status ReadBsdf(const tinygltf::Value& value, const std::string& where, Material& material) {
  Fields fields(value, where);
  const std::string type = fields.Text("type");
  const glm::vec3 color = fields.Color("color");
  material.base_color = glm::vec4(color, material.base_color.a);
  if (type == "PRINCIPLED") {
    ReadPrincipled(fields, material);
    return fields.Verdict();
  }
  material.metallic_roughness_texture = {};
  material.emission = glm::vec3(0.0f);
  material.emission_texture = {};
  material.metallic = 0.0f;
  if (type == "DIFFUSE") {
    material.bsdf = Bsdf::kDiffuse;
    material.roughness = 1.0f;
    if (fields.Has("roughness")) material.diffuse_roughness = static_cast<float>(fields.Number("roughness", 0.0, 1.0));
  } else if (type == "GLOSSY") {
    material.bsdf = Bsdf::kGlossy;
    material.roughness = static_cast<float>(fields.Number("roughness", 0.0, 1.0));
  } else if (type == "EMISSION") {
    material.bsdf = Bsdf::kEmission;
    material.emission = color * static_cast<float>(fields.Number("strength", 0.0, kLargest));
    if (fields.IsTrue("texture")) material.emission_texture = material.base_color_texture;
  } else {
    fields.Complain("type", "is unknown");
  }
  return fields.Verdict();
}

Status ReadNormalMap(const tinygltf::Value& value, const std::string& where, Material& material) {
  Fields fields(value, where);
  const std::string space = fields.Text("space");
  material.normal_scale = static_cast<float>(fields.Number("strength", 0.0, kLargest));
  if (space == "TANGENT") {
    material.normal_rule = NormalMapRule::kTangent;
  } else if (space == "OBJECT") {
    material.normal_rule = NormalMapRule::kObject;
  } else if (space == "BLENDER_OBJECT") {
    material.normal_rule = NormalMapRule::kBlenderObject;
  } else {
    fields.Complain("space", "is unknown");
  }
  return fields.Verdict();
}

Status ReadBump(const tinygltf::Value& value, const std::string& where, Bump& bump) {
  Fields fields(value, where);
  bump.strength = static_cast<float>(fields.Number("strength", 0.0, kLargest));
  bump.distance = static_cast<float>(fields.Number("distance", -kLargest, kLargest));
  bump.srgb = fields.IsTrue("srgb");
  return fields.Verdict();
}

constexpr const char* kStyleProperty = "scumble_style";

// A style from our exporter, or the custom property itself, which Blender's own exporter and others keep.
Expected<std::string> ReadStyle(const tinygltf::Value& extras, const std::string& where) {
  if (Find(extras, "style")) {
    Fields fields(extras.Get("scumble"), where);
    std::string style = fields.Text("style");
    SCUMBLE_RETURN_IF_ERROR(fields.Verdict());
    return style;
  }
  if (!extras.IsObject() || !extras.Has(kStyleProperty)) return std::string();
  const tinygltf::Value& value = extras.Get(kStyleProperty);
  if (value.IsString()) return value.Get<std::string>();
  return InputError(where + ": the property scumble_style is no text: give it the name of a style");
}

}  // namespace

const tinygltf::Value* FindExtrasTexture(const tinygltf::Value& material_extras, const std::string& key) {
  const tinygltf::Value* owner = Find(material_extras, key);
  return owner && owner->IsObject() && owner->Has("texture") ? &owner->Get("texture") : nullptr;
}

Expected<glm::dmat3> ReadMeshStretch(const tinygltf::Mesh& mesh, const std::string& where) {
  const tinygltf::Value* list = Find(mesh.extras, "stretch");
  glm::dmat3 stretch(1.0);
  if (!list) return stretch;
  bool sound = list->IsArray() && list->ArrayLen() == 9;
  for (int i = 0; sound && i < 9; ++i) {
    sound = list->Get(i).IsNumber();
    if (sound) stretch[i / 3][i % 3] = list->Get(i).GetNumberAsDouble();
  }
  const double volume = glm::determinant(stretch);
  if (sound && std::isfinite(volume) && volume > 0.0 && stretch == glm::transpose(stretch)) return stretch;
  return InputError(where + ": in the extras of scumble, 'stretch' is no symmetric matrix of 9 numbers: export it " +
                    "again with this version's export_scene.py");
}

Status ReadMaterialExtras(const tinygltf::Model& model, const std::string& file, Scene& scene) {
  for (std::size_t i = 0; i < model.materials.size() && i < scene.materials.size(); ++i) {
    const tinygltf::Value* bsdf = Find(model.materials[i].extras, "bsdf");
    const std::string where =
        file + ": material " + std::to_string(i) + " '" + Excerpt(model.materials[i].name, 80) + "'";
    SCUMBLE_ASSIGN(scene.materials[i].style, ReadStyle(model.materials[i].extras, where));
    if (bsdf) SCUMBLE_RETURN_IF_ERROR(ReadBsdf(*bsdf, where, scene.materials[i]));
    if (const tinygltf::Value* normal = Find(model.materials[i].extras, "normal")) {
      SCUMBLE_RETURN_IF_ERROR(ReadNormalMap(*normal, where, scene.materials[i]));
    }
    if (const tinygltf::Value* bump = Find(model.materials[i].extras, "bump")) {
      SCUMBLE_RETURN_IF_ERROR(ReadBump(*bump, where, scene.materials[i].bump));
    }
  }
  return Ok();
}

Status ReadSceneExtras(const tinygltf::Model& model, int scene_index, const std::string& file, Scene& scene) {
  if (scene_index < 0 || std::size_t(scene_index) >= model.scenes.size()) return Ok();
  const tinygltf::Value& extras = model.scenes[std::size_t(scene_index)].extras;
  if (Find(extras, "world")) {
    Fields fields(extras.Get("scumble"), file + ": scene " + std::to_string(scene_index));
    scene.world_radiance = fields.Color("world");
    SCUMBLE_RETURN_IF_ERROR(fields.Verdict());
  }
  if (const tinygltf::Value* version = Find(extras, "blender"); version && version->IsString()) {
    ShadeAsCycles(version->Get<std::string>(), scene);
  }
  if (const tinygltf::Value* lost = Find(extras, "lost_camera"); lost && lost->IsString()) {
    scene.lost_camera = Excerpt(lost->Get<std::string>(), kLongestWarning);
  }
  const tinygltf::Value* unsupported = Find(extras, "unsupported");
  if (!unsupported || !unsupported->IsArray()) return Ok();
  for (std::size_t i = 0; i < unsupported->ArrayLen(); ++i) {
    if (i == kMaxWarnings) {
      scene.warnings.push_back("… and " + std::to_string(unsupported->ArrayLen() - i) + " things more");
      break;
    }
    const tinygltf::Value& line = unsupported->Get(static_cast<int>(i));
    if (line.IsString()) scene.warnings.push_back(Excerpt(line.Get<std::string>(), kLongestWarning));
  }
  return Ok();
}

Expected<std::optional<Light>> ReadLightExtras(const tinygltf::Node& node, const std::string& where) {
  const tinygltf::Value* lamp = Find(node.extras, "lamp");
  if (!lamp) return std::optional<Light>();
  Fields fields(*lamp, where);
  Light light;
  const std::string type = fields.Text("type");
  const double energy = fields.Number("energy", 0.0, kLargest);
  light.color = fields.Color("color");
  light.intensity = energy / (4.0 * pi);
  bool shines = true;
  if (type == "POINT" || type == "SPOT") {
    light.radius = fields.Number("radius", 0.0, kLargest);
    if (type == "SPOT") light.type = LightType::kSpot, ReadSpot(fields, light);
  } else if (type == "SUN") {
    light.type = LightType::kSun;
    light.intensity = energy;
    light.angle_degrees = std::min(fields.Number("angle", 0.0, pi + 1e-6) * kDegreesPerRadian, 180.0);
  } else if (type == "AREA") {
    light.type = LightType::kArea;
    shines = ReadArea(fields, light, energy);
  } else {
    fields.Complain("type", "is unknown");
  }
  SCUMBLE_RETURN_IF_ERROR(fields.Verdict());
  if (!shines) light.intensity = 0.0, light.size_x = light.size_y = 1.0;
  return std::optional(light);
}

Status ReadObjectExtras(const tinygltf::Node& node, const std::string& where, Instance& instance) {
  SCUMBLE_ASSIGN(instance.style, ReadStyle(node.extras, where));
  if (!Find(node.extras, "pass_index")) return Ok();
  Fields fields(node.extras.Get("scumble"), where);
  instance.pass_index = static_cast<int>(fields.Number("pass_index", 0.0, kLargestPassIndex));
  return fields.Verdict();
}

namespace {

// The sides of a border, in the order of export_scene.py.
CameraBorder ReadBorder(const tinygltf::Value& extras, Fields& fields) {
  CameraBorder border;
  const tinygltf::Value& list = extras.Get("border");
  if (!list.IsArray() || list.ArrayLen() != 4) return fields.Complain("border", "is no list of 4 numbers"), border;
  double* const sides[] = {&border.left, &border.bottom, &border.right, &border.top};
  for (int i = 0; i < 4; ++i) {
    if (list.Get(i).IsNumber()) *sides[i] = list.Get(i).GetNumberAsDouble();
  }
  const auto fits = [](double from, double to) { return from >= 0.0 && from < to && to <= 1.0; };
  if (!fits(border.left, border.right) || !fits(border.bottom, border.top)) {
    fields.Complain("border", "is no left, bottom, right and top from 0 to 1");
  }
  border.crop = fields.IsTrue("crop");
  return border;
}

}  // namespace

Status ReadCameraExtras(const tinygltf::Node& node, const std::string& where, Camera& camera) {
  const tinygltf::Value* extras = Find(node.extras, "camera");
  if (!extras) return Ok();
  Fields fields(*extras, where);
  const std::string fit = fields.Text("sensor_fit");
  camera.fit = fit == "HORIZONTAL" ? CameraFit::kHorizontal
               : fit == "VERTICAL" ? CameraFit::kVertical
                                   : CameraFit::kLonger;
  camera.aspect.reset();
  if (fields.Has("border")) camera.border = ReadBorder(*extras, fields);
  if (fields.Has("border_size")) camera.border_size = Excerpt(fields.Text("border_size"), 40);
  camera.shift_x = fields.Number("shift_x", -1e6, 1e6);
  camera.shift_y = fields.Number("shift_y", -1e6, 1e6);
  if (camera.orthographic) {
    camera.ymag = fields.Number("ortho_scale", 1e-12, kLargest) / 2.0;
  } else {
    camera.yfov_degrees = fields.Number("angle", 1e-9, pi - 1e-9) * kDegreesPerRadian;
  }
  return fields.Verdict();
}

Expected<std::optional<Curves>> ReadCurvesExtras(const tinygltf::Primitive& primitive, const std::string& where) {
  const tinygltf::Value* const value = Find(primitive.extras, "curves");
  if (!value) return std::optional<Curves>();
  Fields fields(*value, where);
  Curves curves;
  curves.ribbons = fields.IsTrue("ribbons");
  curves.pieces = static_cast<int>(fields.Number("pieces", 1.0, 17.0));
  SCUMBLE_RETURN_IF_ERROR(fields.Verdict());
  return std::optional(std::move(curves));
}

}  // namespace scumble
