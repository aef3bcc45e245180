// The scene of the ray caster: triangles, instances, materials, cameras, lights. Loaders fill it; it is independent of
// file formats. World space is glTF's: metres, right-handed, +Y up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

enum class TextureWrap { kRepeat, kMirror, kClamp };

// A use of a texture: its picture, UV set and repetition, and KHR_texture_transform.
struct TextureUse {
  int texture = -1;  // index into Scene::textures, -1 for none
  int uv_set = 0;    // 0 or 1
  TextureWrap wrap_u = TextureWrap::kRepeat;
  TextureWrap wrap_v = TextureWrap::kRepeat;
  bool nearest = false;  // no bilinear interpolation
  glm::mat3 uv_transform{1.0f};
};

enum class AlphaMode { kOpaque, kMask, kBlend };
// No guide is partly transparent: where a kBlend surface has less alpha, it is a hole, else solid.
inline constexpr float kBlendCutoff = 0.5f;

// A surface's response to light. The last three are Blender's pure shaders, which glTF lacks: diffuse and GGX without
// Fresnel, whose colour is the base colour, and a black surface that only emits.
enum class Bsdf { kMetallicRoughness, kDiffuse, kGlossy, kEmission };

// How a normal map's value becomes a normal (surface/normal_map.h): by glTF's rule, or as Cycles' Normal Map node has
// it in tangent space, in object space, and in the object space of Blender's old renderer.
enum class NormalMapRule { kGltf, kTangent, kObject, kBlenderObject };

// A height over the surface that bends the normal, as Cycles' Bump node. The height is the texel's luminance.
struct Bump {
  TextureUse height_texture = {};
  bool srgb = false;      // the texels are colours, and their luminance is that of the decoded ones
  float distance = 1.0f;  // m, that the surface rises from height 0 to 1; negative: it sinks
  float strength = 1.0f;  // 0 or more; 1: the normal of the risen surface, 0: no bump
};

// Textures are kept as their pictures are stored; colours are decoded from sRGB when sampled, normals are not.
// UV (0, 0) is the picture's top left corner, as in glTF; loaders of other formats flip v.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};  // linear
  TextureUse base_color_texture;
  TextureUse normal_texture;
  float normal_scale = 1.0f;  // Cycles' rules: the Normal Map node's strength
  NormalMapRule normal_rule = NormalMapRule::kGltf;
  Bump bump;  // on the mapped normal
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = true;
  Bsdf bsdf = Bsdf::kMetallicRoughness;
  float metallic = 0.0f;
  float roughness = 1.0f;  // glTF's: GGX's α is its square, 0 is a mirror
  // kDiffuse only: Oren and Nayar's, in [0, 1]; 0 is Lambert. A field of its own, because a metallic-roughness material
  // that becomes kDiffuse becomes Lambert.
  float diffuse_roughness = 0.0f;
  bool cycles4 = false;  // shaded as by Cycles 4 instead of 3, where they differ: guidegen/cycles_version.h
  TextureUse metallic_roughness_texture;  // linear: G multiplies the roughness, B the metalness
  glm::vec3 emission{0.0f};               // radiance, linear, from both sides
  TextureUse emission_texture;
  std::string style{};  // as Instance::style, which takes precedence
};

// Hair. The control points of all curves are a mesh's positions; each curve repeats its first and its last one, which
// its Catmull–Rom segments need at their ends.
struct Curves {
  std::vector<float> radii;             // of each control point, in object space
  std::vector<std::uint32_t> segments;  // of each segment, the first of its four control points
  bool ribbons = true;                  // flat, turned to the ray, with rounded normals; false: round
  int pieces = 3;                       // straight ones of each segment, where it is flat
};

// One glTF primitive: a triangle list with one material, or curves. Every non-empty attribute has one value per
// position.
struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  // unit; loaders always fill them
  std::array<std::vector<glm::vec2>, 2> uvs;
  std::vector<glm::vec4> tangents;  // xyz and handedness; only where a normal map needs them
  std::vector<glm::vec4> colors;    // linear; multiplied into the base colour
  std::vector<glm::uvec3> triangles;
  // The undeformed shape, in the file's own space: the layer `pref`. Empty: equal to `positions`.
  std::vector<glm::vec3> rest_positions;
  // Symmetric. Positions and normals are the object's after this stretch. Normal maps and tangents belong to the object
  // before it, as in Cycles where a mesh has one user.
  glm::dmat3 stretch{1.0};
  int material = 0;  // index into Scene::materials, always valid
  Curves curves;     // where there are any, there are no triangles, normals and texture coordinates

  bool IsCurves() const { return !curves.segments.empty(); }
};

struct Instance {
  std::string object;  // full name: the node's; its hash is the object id
  int mesh = 0;
  glm::dmat4 world_from_object{1.0};
  std::string style{};  // the style that the scene's author assigned; empty: none
  int pass_index = 0;   // Blender's, 0 … 32767; 0: none
};

// The side of the picture that a camera's extent measures: a fixed one, or the longer one of any picture.
enum class CameraFit { kVertical, kHorizontal, kLonger };

// The part of a camera's frame that is drawn, as Blender's render region: sides as fractions of the frame, from its
// left and its bottom; 0 ≤ left < right ≤ 1, 0 ≤ bottom < top ≤ 1.
struct CameraBorder {
  double left = 0.0;
  double bottom = 0.0;
  double right = 1.0;
  double top = 1.0;
  // The picture is what lies in the border: the frame is as many times wider and higher as the border is narrower and
  // lower. Otherwise the picture is the frame, and all outside the border's whole pixels is background.
  bool crop = false;
};

struct Camera {
  std::string name;
  glm::dmat4 world_from_camera{1.0};  // looks down its −Z, +Y up; rotation and translation only
  bool orthographic = false;
  double yfov_degrees = 40.0;  // perspective: full angle, vertical unless `fit` says otherwise, in (0, 180)
  double ymag = 1.0;           // orthographic: half the height, or half the side that `fit` names, m
  CameraFit fit = CameraFit::kVertical;
  double shift_x = 0.0;  // moves the picture's frame right and up across the scene, like Blender's lens shift:
  double shift_y = 0.0;  // fractions of the side that `fit` names
  // Both kinds keep the vertical extent, and the picture's own proportions set the horizontal one. If the file states
  // an aspect (width / height) larger than the picture's, the horizontal extent is kept instead. Used only where `fit`
  // is vertical.
  std::optional<double> aspect;
  double z_near = 0.0;
  double z_far = std::numeric_limits<double>::infinity();
  std::optional<CameraBorder> border;  // empty: the whole frame is drawn
  std::string border_size;             // "960x540": a cropped border's pixels in the file that it is from; may be empty
};

enum class LightType { kPoint, kSpot, kSun, kArea };

// Radiometric units, so that they can be compared with Cycles: glTF's candela and lux are divided by 683 lm/W.
struct Light {
  std::string name;
  LightType type = LightType::kPoint;
  glm::vec3 color{1.0f};            // linear
  double intensity = 1.0;           // point, spot: W/sr; sun: W/m² on a facing surface; area: radiance, W/(sr·m²)
  double inner_cone_degrees = 0.0;  // spot: half angles, as KHR_lights_punctual has them
  double outer_cone_degrees = 45.0;
  glm::dmat4 world_from_light{1.0};  // shines down its −Z
  double radius = 0.0;  // point, spot: m; a disc that turns to face the point it lights, of radiance I / (π r²)
  // Sun: full angular diameter. As in Cycles 3.4, its directions are spread evenly over a flat disc, so that a surface
  // which faces a wide sun receives 2 (1/cos α − 1) / tan² α of its intensity, α half the angle: 0.998 at 10°.
  double angle_degrees = 0.0;
  bool cycles_spot = false;  // spot: Cycles' smoothstep falloff instead of KHR_lights_punctual's
  bool spot_cosine = true;   // with cycles_spot: times cosθ, as in Cycles 3.4
  double spot_blend = 0.0;   // with cycles_spot: Blender's blend; outer_cone_degrees is the half angle
  bool ellipse = false;      // area: an ellipse, or a rectangle
  // Area: m in the world, whatever the matrix's scale; the full extents along the light's own x and y. One-sided.
  double size_x = 1.0;
  double size_y = 1.0;
};

struct Scene;

// The source of a texture, for DecodeTextures of guidegen/scene_textures.h. Immutable: copies of a scene share it.
struct EncodedTexture {
  std::function<Expected<Picture>()> decode;
  std::function<Expected<std::uint64_t>()> count_pixels;  // of the picture that `decode` makes, by the header
  std::size_t bytes = 0;                                  // kept in memory until then
  // Removes the texture from the scene's materials: its picture is empty and no encoded data is left. Null: it is
  // required, and a picture that cannot be decoded is an error.
  std::function<void(Scene&)> leave_out;
};

struct Scene {
  std::string name;  // the file's, for messages
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;  // never empty once loaded
  std::vector<Picture> textures;
  // The source of each texture that is not decoded yet, with an empty picture in `textures`; null or absent: it is
  // decoded.
  std::vector<std::shared_ptr<const EncodedTexture>> encoded_textures;
  std::vector<Camera> cameras;
  std::string lost_camera;  // of a .blend whose active camera is not among these: its name and why
  std::vector<Light> lights;
  bool has_own_lights = true;         // false: `lights` are others than the file's
  glm::vec3 world_radiance{0.0f};     // from every direction without a hit; linear
  std::vector<std::string> warnings;  // unsupported requests of the file, in the user's words
  std::vector<std::string> notes;     // what the loader decided where the file leaves it open, likewise
};

}  // namespace scumble
