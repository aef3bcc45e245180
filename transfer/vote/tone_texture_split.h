// The hybrid of both methods, for exemplars that have a smooth tone and a fine texture at once: tone as the Lit Sphere
// lays it, without a seam, and texture as StyleBlit copies it, unblurred (Sýkora et al. 2019 suggest it).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "core/image/style.h"
#include "scumble/picture.h"
#include "transfer/exemplar/guide_space.h"
#include "transfer/exemplar/illumination.h"
#include "transfer/exemplar/prepared_exemplar.h"
#include "transfer/vote/vote.h"

namespace scumble {

// The tone of each picture of an exemplar: MaskedBlur over its usable pixels, premultiplied. Texture is what the
// picture differs from it by.
std::vector<Picture> MakeBaseLayers(const PreparedExemplar& exemplar, double sigma);

}  // namespace scumble

namespace scumble::internal {

struct HybridInput {
  VoteInput votes;
  const GuideSet& guides;
  const Illumination& illumination;
  std::span<const float> luminance;   // exposed; empty where the illumination is not active
  std::span<const Picture> tones;     // by exemplar
  const GuideSpace* space = nullptr;  // where neighbours are looked for; null: normals alone
  float brightness = 1.0f;            // of the scene's radiance in that space
};

// Every active pixel of the region becomes the tone at its own nearest neighbour, in the exemplar that suits its own
// light, plus the mean of the textures that the chunks around it vote for: the same votes as Vote's. On a sphere the
// tone is read between texels (bilinearly, in 1/256 of a texel), elsewhere, and where more than normals count, at the
// nearest neighbour itself. Sums are integers with premultiplied colours; nothing is clamped before the end. Where the
// tone is the same everywhere and the paint opaque, this is Vote to the bit. Writes straight alpha into `out`; other
// pixels are left alone. False: asked to stop.
bool VoteHybrid(const HybridInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
