// The effect of a tint on paint, for one pixel or for a vector of them, by the formulas in transfer/tint/colorize.h.
//
// Text to be included after core/image/color_math-inl.h in a namespace of Lanes. A tint first takes the albedo, which
// neighbouring pixels mostly share, then any number of paints. Paint comes in 16-bit sRGB codes and leaves in unrounded
// codes of 0 … 65535.

// 0 … top; NaN becomes 0.
inline Lane ClampTo(Lane x, float top) { return Select(Less(0.0f, x), Min(x, top), 0.0f); }

// Paint × (1 − w + w · albedo).
//
// On the curved part of sRGB a code c times a linear factor f is (c + kOffset) · f^(5/12) − kOffset: paint need not be
// decoded.
class MultiplyingTint {
 public:
  explicit MultiplyingTint(const Tint& tint) : weight_(tint.weight) {}

  void SetAlbedo(LaneColor albedo) {
    factor_ = {Factor(albedo.r), Factor(albedo.g), Factor(albedo.b)};
    root_ = Each(FiveTwelfths, factor_);
    shift_ = {(root_.r - 1.0f) * kOffset, (root_.g - 1.0f) * kOffset, (root_.b - 1.0f) * kOffset};
  }
  LaneColor Tinted(LaneColor codes) const {
    return {Channel(codes.r, factor_.r, root_.r, shift_.r), Channel(codes.g, factor_.g, root_.g, shift_.g),
            Channel(codes.b, factor_.b, root_.b, shift_.b)};
  }

 private:
  // A factor of 1e9 lifts even code 1 to white.
  Lane Factor(Lane albedo) const { return ClampTo((1.0f - weight_) + weight_ * albedo, 1e9f); }

  static Lane Channel(Lane code, Lane factor, Lane root, Lane shift) {
    const Lane curved = Min(code * root + shift, kWhite);
    const Choice on_the_curve = Less(kKink, Min(code, curved));
    if (All(on_the_curve)) return curved;
    return Select(on_the_curve, curved, ClampedCode(LinearFromCode(code) * factor));
  }

  float weight_;
  LaneColor factor_, root_, shift_;
};

// Oklab's lightness from the paint, hue and chroma from the albedo.
//
// Colours are stored as Oklab's three cube roots, split into lightness and the difference of each root from it: scaling
// the differences scales the chroma.
class OklabTint {
 public:
  explicit OklabTint(const Tint& tint)
      : weight_(tint.weight), reference_(tint.reference_lightness), per_reference_(1.0f / Max(reference_, kLeast)) {}

  void SetAlbedo(LaneColor albedo) {
    const LaneColor base{ClampTo(albedo.r, 1.0f), ClampTo(albedo.g, 1.0f), ClampTo(albedo.b, 1.0f)};
    scene_ = PartsOf(Each(CubeRoot, ConesFromLinear(base)));
    per_room_ = 1.0f / Max(1.0f - Min(reference_, scene_.lightness), kLeast);
    top_ = Max(Max(Max(base.r, base.g), base.b), kBrightest);
  }

  // Three steps. Each depends on its own results for long: code that tints many pixels does each step for all of them.
  static LaneColor RootsOfPaint(LaneColor codes) {
    return Each(CubeRoot, ConesFromLinear(Each(LinearFromCode, codes)));
  }
  LaneColor Linear(LaneColor own) const {
    const Lane lightness = LightnessFromRoots(own);
    // Darker paint than the reference has a share below 1, lighter paint a rise above 0.
    const Lane share = Min(lightness * per_reference_, 1.0f);
    const Lane rise = Min(Max((lightness - reference_) * per_room_, 0.0f), 1.0f);
    Parts target{share * scene_.lightness + rise * (1.0f - scene_.lightness),
                 Scaled(scene_.chroma, share - rise * rise)};
    const LaneColor linear = FitIn(target, top_);
    if (!(weight_ < 1.0f)) return linear;
    const LaneColor to = RootsOf(target);
    Parts mixed = PartsOf({Mixed(own.r, to.r), Mixed(own.g, to.g), Mixed(own.b, to.b)});
    return FitIn(mixed, 1.0f);
  }
  static LaneColor Encoded(LaneColor linear) { return Each(ClampedCode, linear); }

 private:
  static constexpr float kLeast = 1e-6f;
  static constexpr float kBrightest =
      0.98f;  // of a channel of the white that lighter paint approaches, so that none is clipped

  struct Parts {
    Lane lightness;
    LaneColor chroma;
  };

  static Parts PartsOf(LaneColor roots) {
    const Lane lightness = LightnessFromRoots(roots);
    return {lightness, {roots.r - lightness, roots.g - lightness, roots.b - lightness}};
  }
  static LaneColor RootsOf(const Parts& color) {
    return {color.lightness + color.chroma.r, color.lightness + color.chroma.g, color.lightness + color.chroma.b};
  }
  static LaneColor Scaled(LaneColor chroma, Lane factor) {
    return {chroma.r * factor, chroma.g * factor, chroma.b * factor};
  }
  Lane Mixed(Lane own, Lane target) const { return own + (target - own) * weight_; }

  static Choice InGamut(LaneColor c, Lane top) {
    constexpr float kSlack = 1e-4f;
    return Both(Less(Max(Max(c.r, c.g), c.b), top + kSlack), Less(-kSlack, Min(Min(c.r, c.g), c.b)));
  }

  // Reduces the chroma if that brings all channels within 0 … top; returns the linear colour.
  static LaneColor FitIn(Parts& color, Lane top) {
    const LaneColor linear = LinearFromRoots(RootsOf(color));
    const Choice fits = InGamut(linear, top);
    if (All(fits)) return linear;
    Lane inside = 0.0f, outside = 1.0f;
    for (int step = 0; step < 10; ++step) {
      const Lane middle = 0.5f * (inside + outside);
      const Choice in = InGamut(LinearFromRoots(RootsOf({color.lightness, Scaled(color.chroma, middle)})), top);
      inside = Select(in, middle, inside);
      outside = Select(in, outside, middle);
    }
    color.chroma = Scaled(color.chroma, Select(fits, 1.0f, inside));
    return LinearFromRoots(RootsOf(color));
  }

  float weight_;
  Lane reference_, per_reference_;
  Parts scene_;
  Lane per_room_, top_;
};
