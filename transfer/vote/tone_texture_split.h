// The hybrid of both methods, for exemplars with smooth tone and fine texture: a base layer laid as by the Lit Sphere,
// without a seam, and a detail layer copied as by StyleBlit, unblurred (Sýkora et al. 2019 suggest it).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/filter/light_contour.h"
#include "core/image/guides.h"
#include "core/image/style.h"
#include "scumble/picture.h"
#include "transfer/exemplar/guide_space.h"
#include "transfer/exemplar/illumination.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/vote/vote.h"

namespace scumble {

// The exemplar with a base layer in place of each picture: MaskedBlur over its usable pixels, straight alpha.
PreparedExemplar MakeBaseLayers(const PreparedExemplar& exemplar, double sigma);

}  // namespace scumble

namespace scumble::internal {

struct HybridInput {
  VoteInput votes;
  const GuideSet& guides;
  const Illumination& illumination;
  std::span<const float> luminance;   // exposed; empty where the illumination is not active
  const PreparedExemplar& base;       // of the votes' exemplar, by MakeBaseLayers
  const GuideSpace* space = nullptr;  // the space of the search; null: normals alone
  float brightness = 1.0f;            // of the scene's radiance in that space
};

// Every active pixel of the region becomes the base layer at its own nearest neighbour, in the exemplar that suits its
// own light, plus the detail that the chunks around it vote for: Vote on the paint, minus Vote on the base layers, with
// the votes of one window. On a sphere the own base layer is read between texels (bilinearly, in 1/256 of a texel). On
// scenes, and with weights on other guides than normals, it is read at the nearest neighbour itself. Sums and
// differences are of integers with premultiplied colours; nothing is clamped before the end. If the base layer is
// constant and the paint opaque, this equals Vote to the bit. `base_votes` is working memory: it becomes as large as
// `out`. Writes straight alpha into `out`; other pixels stay. Reports each row of the region twice. False: cancelled.
bool VoteHybrid(const HybridInput& input, Picture& base_votes, Picture& out, RowProgress& progress);

// One colour of the hybrid.
struct HybridLayers {
  const PreparedExemplar& paint;
  const PreparedExemplar& base;  // by MakeBaseLayers
  const Illumination& illumination;
  const GuideSpace* space = nullptr;  // as in HybridInput
};

// The guides of a place, as the search reads them.
struct HybridGuide {
  glm::vec3 normal;
  float light = 0.0f;                   // exposed luminance
  const float* extra_values = nullptr;  // only with a space
};

// VoteHybrid's colour there, from the votes on the base layers and, in `texel`, on the paint.
void AddBaseLayer(const HybridLayers& layers, const HybridGuide& guide, const std::uint16_t* base_vote,
                  std::uint16_t* texel);

// What the hybrid looks at.
struct HybridFrame {
  const GuideSet& guides;
  std::span<const float> luminance;  // both as in HybridInput
  float brightness = 1.0f;
};

// AddBaseLayer for many pixels. Where the choice of the exemplar changes within an object, the border would be a
// staircase of pixels: there a pixel takes both colours by their area (core/filter/light_contour.h), in linear light.
// Pixels that show several surfaces do not: their fragments have each its own light. Shared by all threads; what it is
// made of must outlive it.
class HybridTone {
 public:
  HybridTone(const HybridLayers& layers, const HybridFrame& frame);
  // On the pixels x0 … x1 - 1 of a row that are active; `active` is of the row, from column 0 on. Both pictures are of
  // the guides' size.
  void AddToRow(const std::uint8_t* active, int y, int x0, int x1, const Picture& base_votes, Picture& out) const;

 private:
  // A pixel beside a border: the votes on its paint, and the pixel on the other side.
  struct BorderPixel {
    int x;
    std::array<std::uint16_t, 4> vote;
    LightContour::Beyond beyond;
  };

  std::vector<BorderPixel> BesideBorders(const std::uint8_t* active, int y, int x0, int x1, const Picture& out) const;
  float LightOf(std::size_t pixel) const { return frame_.luminance.empty() ? 0.0f : frame_.luminance[pixel]; }
  void Add(std::size_t pixel, float light, const std::uint16_t* base_vote, std::uint16_t* texel) const;
  bool AddOpaque(glm::vec3 normal, int own, const std::uint16_t* base_vote, std::uint16_t* texel) const;

  HybridLayers layers_;
  HybridFrame frame_;
  std::span<const float> normals_[3];
  std::optional<LightContour> borders_;  // only with several exemplars
  ExemplarRows rows_;
  float half_;  // of the sphere's size
  bool may_be_quick_, has_several_;
};

}  // namespace scumble::internal
