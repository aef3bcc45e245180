// The space in which a style matches if transfer.guide_weights names more layers than the normal. Every pixel of the
// scene and of the exemplar is a point in it, and paint comes from the nearest point. Guides of light add what normals
// lack: the lit part of a flat wall, and the end of a shadow (Fišer et al., "StyLit: Illumination-Guided Example-Based
// Stylization of 3D Renderings", SIGGRAPH 2016).
//
// A point's coordinates are the values of each layer, times the layer's weight:
//   normal        x, y, z. For a search, a normal that faces away is turned to the rim (FacingDirection), as in a tree
//                 of normals alone.
//   albedo        r, g, b, between 0 and 1; 1 above.
//   shadow        between 0 and 1.
//   outline       1 - d / kOutlineReach, and 0 beyond that: d is the distance to the nearest outline in pixels at the
//                 reference height. The edge guide of StyLit, which keeps thin parts in the paint of the rim.
//   luminance,    L / (1 + L) of each channel: 0 is darkness, 0.5 the exemplar's 90th percentile `white`, and nothing
//   lpe.*         is above 1. Radiance has no upper bound, and a highlight must not outweigh all the rest. L is the
//                 exemplar's radiance / white; the scene's is exposed, · 2^stops / white. With the exposure that
//                 MeasureExposure gives, both are shares of their own 90th percentile.
// NaN and what is below 0 count as 0, infinite radiance as 1.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "transfer/nearest/guide_distance.h"
#include "transfer/nearest/guide_tree.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/source.h"

namespace scumble {

// Immutable; any number of threads may use it at once.
class GuideSpace {
 public:
  // The most extra dimensions, beside the normal's.
  static constexpr int kMaxExtra = 21;
  static constexpr double kOutlineReach = 24.0;  // pixels at the reference height

  // Over the usable pixels of each exemplar, which must hold the layers with a weight above 0: their guides are sampled
  // at pixel centres. `scale`: pixels of the picture for one of the reference height. The result of Nearest may be (1 +
  // nearest_error) times as far as the nearest. A kInput error names an exemplar whose guides lack a layer. One thread,
  // O(pixels · log) an exemplar; 4 bytes a coordinate of each pixel, and a PointTree.
  static Expected<GuideSpace> Build(const GuideWeights& weights, std::span<const Exemplar> exemplars,
                                    std::shared_ptr<const PreparedExemplar> prepared, double nearest_error = 0.0,
                                    double scale = 1.0);

  float normal_weight() const { return normal_weight_; }
  int extra_dimensions() const { return extra_dimensions_; }  // extra dimensions, beside the normal's
  int dimensions() const { return extra_dimensions_ + (normal_weight_ > 0.0f ? 3 : 0); }
  std::span<const Layer> layers() const { return layers_; }  // those of the extra dimensions, in the enum's order

  // Radiance: whether it has a weight; whether a tenth of an exemplar is lit in such a layer; the layer that measures
  // its exposure (the first of luminance, lpe.LDE, lpe.LD12E, lpe.full, lpe.LDDE and lpe.LSE with a weight that is so
  // lit, else the first with a weight); and that layer's 90th percentile in the brightest of the exemplars, above 0: 1
  // if none is lit.
  bool has_radiance() const { return has_radiance_; }
  bool is_lit() const { return is_lit_; }
  Layer radiance() const { return radiance_; }
  float white() const { return white_; }

  // Reads the extra dimensions of a scene's pixel. `brightness` is 2^stops.
  void Read(const GuideSet& scene, std::size_t pixel, float brightness, float* extra_values) const;

  // The least and the largest coordinate of exemplar k's usable pixels in one of layers(), unweighted: in one of its
  // channels, or in all.
  struct Range {
    float least = 0.0f, largest = 0.0f;
  };
  Range RangeOf(int k, Layer layer, int channel) const;
  Range RangeOf(int k, Layer layer) const;

  // Extra dimensions between each layer's least value (share 0) and its largest (share 1).
  void Blend(int k, float share, float* extra_values) const;

  // Calls visit(value) for each coordinate of a usable pixel of exemplar k, the normal's first.
  template <class Visit>
  void ForEachCoordinate(int k, Source at, const Visit& visit) const {
    if (normal_weight_ > 0.0f) {
      const glm::vec3 normal = normal_weight_ * exemplar_->Normal(at.x, at.y);
      visit(normal.x), visit(normal.y), visit(normal.z);
    }
    const float* extra_values = ExtraValuesAt(k, at);
    for (int d = 0; d < extra_dimensions_; ++d) visit(extra_values[d]);
  }

  // The extra dimensions of a pixel of exemplar k.
  const float* ExtraValuesAt(int k, Source at) const { return values_[std::size_t(k)].data() + Offset(at); }

  // The usable pixel of exemplar k that is nearest, exactly unless an error is allowed; ties to the lowest (y, x).
  // `normal` is unweighted, `extra_values` is weighted.
  Source Nearest(int k, glm::vec3 normal, const float* extra_values) const;

  // Whether the test accepts `at` for a pixel, as GuideTest does; `extra` is the light's part.
  bool Alike(const GuideTest& test, int k, glm::vec3 normal, const float* extra_values, Source at, float extra) const {
    const float off = test.ExtraDistance(extra_values, ExtraValuesAt(k, at), extra_dimensions_);
    return test.Alike(normal_weight_ * normal, normal_weight_ * exemplar_->Normal(at.x, at.y), off, extra);
  }
  // Whether two pixels of exemplar k are alike in the extra dimensions.
  bool AlikeRest(const GuideTest& test, int k, Source a, Source b) const {
    return test.Alike(glm::vec3(0.0f), glm::vec3(0.0f),
                      test.ExtraDistance(ExtraValuesAt(k, a), ExtraValuesAt(k, b), extra_dimensions_), 0.0f);
  }
  // The distance that is compared with the threshold there.
  float Distance(const GuideTest& test, int k, glm::vec3 normal, const float* extra_values, Source at) const {
    const float off = test.ExtraDistance(extra_values, ExtraValuesAt(k, at), extra_dimensions_);
    return test.Distance(normal_weight_ * normal, normal_weight_ * exemplar_->Normal(at.x, at.y), off);
  }

 private:
  // A tree over the dimensions that differ among the usable pixels, and the places of those.
  struct Tree {
    PointTree points;
    std::vector<Source> sources;
  };

  // One of the extra dimensions.
  struct Part {
    Layer layer;
    int component;
    bool radiance;
    float weight;
  };
  // What values are multiplied by, or divided by.
  struct Units {
    float light = 1.0f;          // of radiance
    float outline_reach = 1.0f;  // in the guides' pixels
  };

  std::size_t Offset(Source at) const {
    return (std::size_t(at.y) * exemplar_->width() + at.x) * static_cast<std::size_t>(extra_dimensions_);
  }
  void ReadAll(const GuideSet& guides, std::size_t pixel, const Units& units, float* extra_values) const;
  void SampleExemplar(const GuideSet& guides, std::vector<float>& values) const;
  Tree PlantTree(int k) const;

  std::shared_ptr<const PreparedExemplar> exemplar_;
  float normal_weight_ = 1.0f;
  double nearest_error_ = 0.0;
  float outline_reach_ = 1.0f;  // in pixels of the picture
  std::vector<Layer> layers_;
  std::vector<float> weights_;
  std::vector<Part> parts_;
  int extra_dimensions_ = 0;
  bool has_radiance_ = false, is_lit_ = false;
  Layer radiance_ = Layer::kLuminance;
  float white_ = 1.0f;
  std::vector<std::vector<float>> values_;  // by exemplar: extra dimensions of each pixel
  std::vector<Tree> trees_;                 // by exemplar
};

}  // namespace scumble
