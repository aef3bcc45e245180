// Oklab, many colours at once: OklabFromLinear and LinearFromOklab bit for bit, but where cube roots are doubtful, which
// is said. Included once for each instruction set, by Highway's rules.
#if defined(SCUMBLE_TRANSFER_OKLAB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_TRANSFER_OKLAB_INL_H_
#undef SCUMBLE_TRANSFER_OKLAB_INL_H_
#else
#define SCUMBLE_TRANSFER_OKLAB_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A colour, linear (r, g, b) or Oklab's (L, a, b), of each lane.
template <class D>
struct Triple {
  hn::Vec<D> a, b, c;
};

// Smaller numbers than this, 0 excepted, have no known cube root.
constexpr float kLeastCube = 1e-17f;

// How far, as a share of the root, the plain formula's and the one below may be apart: the one errs by less than 1.2e-12,
// the other by less than 2e-13.
constexpr float kRootDoubt = 2e-12f;

// f of each of the three, one beside the other: chains of steps that wait for each other run abreast.
template <class D, class F, class... More>
HWY_INLINE Triple<D> Each(const F& f, const Triple<D>& first, const More&... more) {
  return {f(first.a, more.a...), f(first.b, more.b...), f(first.c, more.c...)};
}

// `root` + what is missing of x's cube root, which is x - root³ times a third of 1 / root², as good as floats have it;
// rounded once. Doubtful where the true sum is so near to the middle of two floats that it might round to the other.
template <class D>
HWY_INLINE Triple<D> Improve(D d, Triple<D> x, Triple<D> root, Triple<D> third, hn::Mask<D>& doubtful) {
  using V = hn::Vec<D>;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  // Products as sums of two floats, exact because multiplication and addition are fused.
  const auto square = Each([](V r) HWY_ATTR { return hn::Mul(r, r); }, root);
  const auto square_rest = Each([](V r, V s) HWY_ATTR { return hn::MulSub(r, r, s); }, root, square);
  const auto cube = Each([](V r, V s) HWY_ATTR { return hn::Mul(s, r); }, root, square);
  const auto cube_rest = Each([](V r, V s, V c) HWY_ATTR { return hn::MulSub(s, r, c); }, root, square, cube);
  auto off = Each([](V v, V c) HWY_ATTR { return hn::Sub(v, c); }, x, cube);
  off = Each([](V o, V c) HWY_ATTR { return hn::Sub(o, c); }, off, cube_rest);
  off = Each([](V o, V s, V r) HWY_ATTR { return hn::NegMulAdd(s, r, o); }, off, square_rest, root);
  const auto doubt = Each([&](V r) HWY_ATTR { return hn::Mul(r, hn::Set(d, kRootDoubt)); }, root);
  const auto least = Each([](V o, V t, V u) HWY_ATTR { return hn::MulSub(o, t, u); }, off, third, doubt);
  const auto most = Each([](V o, V t, V u) HWY_ATTR { return hn::MulAdd(o, t, u); }, off, third, doubt);
  const auto low = Each([](V r, V m) HWY_ATTR { return hn::Add(r, m); }, root, least);
  const auto high = Each([](V r, V m) HWY_ATTR { return hn::Add(r, m); }, root, most);
#else
  const auto bound = [&](V cube, V guess, V part, float doubt) HWY_ATTR {
    const hn::Repartition<double, D> wide;
    const hn::Rebind<float, decltype(wide)> narrow;
    HWY_ALIGN float cubes[16], roots[16], thirds[16];
    hn::Store(cube, d, cubes), hn::Store(guess, d, roots), hn::Store(part, d, thirds);
    for (std::size_t i = 0; i < hn::Lanes(d); i += hn::Lanes(narrow)) {
      const auto r = hn::PromoteTo(wide, hn::Load(narrow, roots + i));
      const auto off = hn::Sub(hn::PromoteTo(wide, hn::Load(narrow, cubes + i)), hn::Mul(hn::Mul(r, r), r));
      const auto better = hn::Add(r, hn::Mul(off, hn::PromoteTo(wide, hn::Load(narrow, thirds + i))));
      hn::Store(hn::DemoteTo(narrow, hn::Add(better, hn::Mul(r, hn::Set(wide, doubt)))), narrow, roots + i);
    }
    return hn::Load(d, roots);
  };
  const auto low = Each([&](V v, V r, V t) HWY_ATTR { return bound(v, r, t, -kRootDoubt); }, x, root, third);
  const auto high = Each([&](V v, V r, V t) HWY_ATTR { return bound(v, r, t, kRootDoubt); }, x, root, third);
#endif
  doubtful = hn::Or(hn::Or(doubtful, hn::Ne(low.a, high.a)), hn::Or(hn::Ne(low.b, high.b), hn::Ne(low.c, high.c)));
  return high;
}

// Of 0 and of kLeastCube … 2. By Newton's method for 1 / root, which needs no division.
template <class D>
HWY_INLINE Triple<D> CubeRoots(D d, Triple<D> x, hn::Mask<D>& doubtful) {
  using V = hn::Vec<D>;
  const hn::RebindToSigned<D> di;
  const auto one = hn::Set(d, 1.0f), third = hn::Set(d, 1.0f / 3.0f), two_ninths = hn::Set(d, 2.0f / 9.0f);
  // A third of the exponent, negative, and a bit more: within 4%.
  auto z = Each([&](V v) HWY_ATTR { return hn::ConvertTo(d, hn::BitCast(di, v)); }, x);
  z = Each([&](V v) HWY_ATTR { return hn::NegMulAdd(v, third, hn::Set(d, 1419900032.0f)); }, z);
  z = Each([&](V v) HWY_ATTR { return hn::BitCast(d, hn::ConvertTo(di, v)); }, z);
  auto square = Each([](V v) HWY_ATTR { return hn::Mul(v, v); }, z);
  auto root = Each([](V v, V s) HWY_ATTR { return hn::Mul(v, s); }, x, square);
  auto off = Each([&](V r, V v) HWY_ATTR { return hn::NegMulAdd(r, v, one); }, root, z);
  auto series = Each([&](V o) HWY_ATTR { return hn::MulAdd(o, two_ninths, third); }, off);
  off = Each([](V v, V o) HWY_ATTR { return hn::Mul(v, o); }, z, off);
  z = Each([](V v, V o, V s) HWY_ATTR { return hn::MulAdd(o, s, v); }, z, off, series);
  // From here on what is missing is small enough for its first power.
  square = Each([](V v) HWY_ATTR { return hn::Mul(v, v); }, z);
  root = Each([](V v, V s) HWY_ATTR { return hn::Mul(v, s); }, x, square);
  off = Each([&](V r, V v) HWY_ATTR { return hn::NegMulAdd(r, v, one); }, root, z);
  series = Each([&](V o) HWY_ATTR { return hn::MulAdd(o, two_ninths, third); }, off);
  off = Each([&](V o) HWY_ATTR { return hn::Mul(o, hn::Set(d, 2.0f / 3.0f)); }, off);
  const auto part = Each([](V s, V t) HWY_ATTR { return hn::Mul(s, t); }, square, series);
  root = Each([](V r, V o) HWY_ATTR { return hn::MulAdd(r, o, r); }, root, off);
  return Improve(d, x, root, part, doubtful);
}

// kA · a + kB · b + kC · c, in this order, each rounded.
template <class D>
HWY_INLINE hn::Vec<D> Sum(D d, float a, float b, float c, Triple<D> v) {
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, a), v.a), hn::Mul(hn::Set(d, b), v.b)), hn::Mul(hn::Set(d, c), v.c));
}

template <class D>
HWY_INLINE Triple<D> OklabFromLinear(D d, Triple<D> rgb, hn::Mask<D>& doubtful) {
  const Triple<D> cubes{Sum(d, 0.4122214708f, 0.5363325363f, 0.0514459929f, rgb),
                        Sum(d, 0.2119034982f, 0.6806995451f, 0.1073969566f, rgb),
                        Sum(d, 0.0883024619f, 0.2817188376f, 0.6299787005f, rgb)};
  const Triple<D> roots = CubeRoots(d, cubes, doubtful);
  return {Sum(d, 0.2104542553f, 0.7936177850f, -0.0040720468f, roots),
          Sum(d, 1.9779984951f, -2.4285922050f, 0.4505937099f, roots),
          Sum(d, 0.0259040371f, 0.7827717662f, -0.8086757660f, roots)};
}

template <class D>
HWY_INLINE Triple<D> LinearFromOklab(D d, Triple<D> lab) {
  const auto cube = [&](float b, float c) HWY_ATTR {
    const auto root = hn::Add(hn::Add(lab.a, hn::Mul(hn::Set(d, b), lab.b)), hn::Mul(hn::Set(d, c), lab.c));
    return hn::Mul(hn::Mul(root, root), root);
  };
  const Triple<D> cubes{cube(0.3963377774f, 0.2158037573f), cube(-0.1055613458f, -0.0638541728f),
                        cube(-0.0894841775f, -1.2914855480f)};
  return {Sum(d, 4.0767416621f, -3.3077115913f, 0.2309699292f, cubes),
          Sum(d, -1.2684380046f, 2.6097574011f, -0.3413193965f, cubes),
          Sum(d, -0.0041960863f, -0.7034186147f, 1.7076147010f, cubes)};
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#endif
