// The sums of surface.cpp's FindTrianglePoint in its order, a lane a pixel. Where lanes meet different triangles, each
// triangle is blended into its lanes: there are one to three in 4 × 2 pixels, and their records are in the cache.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "guidegen/cast/tile_surface.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "guidegen/cast/tile_surface.h"
#include "guidegen/surface/shading_normal.h"

HWY_BEFORE_NAMESPACE();
namespace scumble {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// Eight at the most: half a square.
using Doubles = hn::CappedTag<double, 8>;
using Floats = hn::Rebind<float, Doubles>;
using Keys = hn::Rebind<std::uint64_t, Doubles>;
using Words = hn::Rebind<std::uint32_t, Doubles>;
using D = hn::Vec<Doubles>;
using F = hn::Vec<Floats>;

struct D3 {
  D x, y, z;
};

HWY_INLINE D Dot(const D3& a, const D3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE D3 SetAll(const double* v) {
  const Doubles d;
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

template <class M>
HWY_INLINE void Blend(M lanes, const double* v, D3& into) {
  const Doubles d;
  into.x = hn::IfThenElse(lanes, hn::Set(d, v[0]), into.x);
  into.y = hn::IfThenElse(lanes, hn::Set(d, v[1]), into.y);
  into.z = hn::IfThenElse(lanes, hn::Set(d, v[2]), into.z);
}

// The triangles of the lanes.
struct LaneTriangles {
  D3 corner, first_edge, second_edge, area, facing;
  D edge_on, area_length, largest;
  F normal[9];

  template <bool kPoints>
  HWY_INLINE void SetAllTo(const TriangleRecord& record) {
    const Floats f;
    corner = SetAll(record.corner), first_edge = SetAll(record.first_edge);
    second_edge = SetAll(record.second_edge), area = SetAll(record.area);
    edge_on = hn::Set(Doubles(), record.edge_on), area_length = hn::Set(Doubles(), record.area_length);
    for (int i = 0; i < 9; ++i) normal[i] = hn::Set(f, record.normal[i]);
    if constexpr (kPoints) {
      facing = SetAll(record.facing);
      largest = hn::Set(Doubles(), record.largest_coordinate);
    }
  }

  template <bool kPoints, class M, class N>
  HWY_INLINE void SetSome(M lanes, N float_lanes, const TriangleRecord& record) {
    const Floats f;
    Blend(lanes, record.corner, corner), Blend(lanes, record.first_edge, first_edge);
    Blend(lanes, record.second_edge, second_edge), Blend(lanes, record.area, area);
    edge_on = hn::IfThenElse(lanes, hn::Set(Doubles(), record.edge_on), edge_on);
    area_length = hn::IfThenElse(lanes, hn::Set(Doubles(), record.area_length), area_length);
    for (int i = 0; i < 9; ++i) normal[i] = hn::IfThenElse(float_lanes, hn::Set(f, record.normal[i]), normal[i]);
    if constexpr (kPoints) {
      Blend(lanes, record.facing, facing);
      largest = hn::IfThenElse(lanes, hn::Set(Doubles(), record.largest_coordinate), largest);
    }
  }
};

// The objects of the lanes.
struct LaneObjects {
  D3 column[3];
  D winding;
  F object_id, material_id;

  HWY_INLINE void SetAllTo(const ObjectRecord& record) {
    for (int i = 0; i < 3; ++i) column[i] = SetAll(record.view_from_normal + 3 * i);
    winding = hn::Set(Doubles(), record.winding);
    object_id = hn::Set(Floats(), record.object_id), material_id = hn::Set(Floats(), record.material_id);
  }

  template <class M, class N>
  HWY_INLINE void SetSome(M lanes, N float_lanes, const ObjectRecord& record) {
    for (int i = 0; i < 3; ++i) Blend(lanes, record.view_from_normal + 3 * i, column[i]);
    winding = hn::IfThenElse(lanes, hn::Set(Doubles(), record.winding), winding);
    object_id = hn::IfThenElse(float_lanes, hn::Set(Floats(), record.object_id), object_id);
    material_id = hn::IfThenElse(float_lanes, hn::Set(Floats(), record.material_id), material_id);
  }
};

HWY_INLINE D ZeroAtLeast(D v) {
  const D zero = hn::Zero(Doubles());
  return hn::IfThenElse(hn::Lt(v, zero), zero, v);
}

HWY_INLINE D Magnitude(const D3& v) {
  const auto larger = [&](D a, D b) { return hn::IfThenElse(hn::Lt(a, b), b, a); };
  return larger(larger(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
}

// The rays of the lanes, expanded from the tile's.
struct LaneRays {
  explicit LaneRays(const TileRays& rays) : orthographic(rays.orthographic) {
    for (int lane = 0; lane < 8; ++lane) {
      for (int square = 0; square < kTileSquares; ++square) {
        across[square][lane] = rays.across[std::size_t(square * kSquareSide + lane % kSquareSide)];
      }
      for (int pair = 0; pair < kTileSide / 2; ++pair) {
        up[pair][lane] = rays.up[std::size_t(2 * pair + lane / kSquareSide)];
      }
    }
  }
  alignas(64) double across[kTileSquares][8];
  alignas(64) double up[kTileSide / 2][8];
  bool orthographic;
};

// Of the tile's directions, in m; none of them is shorter than 1.
double LongestRay(const TileRays& rays) {
  if (rays.orthographic) return 1.0;
  const auto largest_square = [](const auto& steps) {
    return std::max(steps.front() * steps.front(), steps.back() * steps.back());
  };
  return std::sqrt(1.0 + largest_square(rays.across) + largest_square(rays.up));
}

class TileWork {
 public:
  TileWork(const TileHits& hits, const TileRays& rays, TriangleCache& triangles, bool bends_normals, TileGuides& guides,
           TilePoints* points)
      : hits_(hits),
        rays_(rays),
        longest_ray_(LongestRay(rays)),
        bends_normals_(bends_normals),
        triangles_(triangles),
        guides_(guides),
        points_(points) {
    guides_.left_over_count = 0;
    triangles_.Begin();
    for (std::size_t i = 0; i < kTilePixels; ++i) keys_[i] = std::uint64_t(hits.object[i]) << 32 | hits.primitive[i];
  }

  template <bool kPoints>
  HWY_INLINE void Run() {
    const std::size_t step = hn::Lanes(Doubles());
    for (std::size_t pixel = 0; pixel < kTilePixels; pixel += step) Lanes<kPoints>(pixel);
    for (std::size_t i = 0; i < work_count_; ++i) MakeUnits<kPoints>(work_[i]);
  }

 private:
  using Mask = hn::Mask<Doubles>;
  using FloatMask = hn::Mask<Floats>;

  HWY_INLINE FloatMask SameObject(std::size_t pixel, std::uint32_t object) const {
    const Words w;
    return hn::RebindMask(Floats(), hn::Eq(hn::Load(w, hits_.object.data() + pixel), hn::Set(w, object)));
  }

  HWY_INLINE FloatMask SameTriangle(std::size_t pixel, std::uint32_t object, std::uint32_t primitive) const {
    const Words w;
    const auto same = hn::Eq(hn::Load(w, hits_.primitive.data() + pixel), hn::Set(w, primitive));
    return hn::And(SameObject(pixel, object), hn::RebindMask(Floats(), same));
  }

  HWY_INLINE void LeaveOver(std::size_t pixel, Mask lanes) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Doubles(), lanes, bytes);
    for (unsigned bits = bytes[0]; bits != 0; bits &= bits - 1) {
      guides_.left_over[std::size_t(guides_.left_over_count++)] =
          static_cast<std::uint8_t>(pixel + unsigned(std::countr_zero(bits)));
    }
  }

  HWY_INLINE void StoreBackground(std::size_t pixel) {
    const Floats f;
    hn::Store(hn::Set(f, std::numeric_limits<float>::infinity()), f, guides_.depth.data() + pixel);
    hn::Store(hn::Zero(f), f, guides_.object.data() + pixel);
    hn::Store(hn::Zero(f), f, guides_.material.data() + pixel);
    for (auto& plane : guides_.normal) hn::Store(hn::Zero(f), f, plane.data() + pixel);
  }

  // Where rays meet the planes of their triangles.
  struct Meeting {
    D along;      // the ray's direction times the triangle's area
    D v, w;       // barycentric
    Mask missed;  // outside of the triangle, or edge-on
    HWY_INLINE D Mix(D corner, D first, D second) const {
      return hn::Add(hn::Sub(corner, hn::Mul(first, v)), hn::Mul(second, w));
    }
  };

  // Shading normals in view space, before they are unit vectors.
  struct ViewNormal {
    D3 shading;
    D squared;      // its squared length
    Mask ordinary;  // neither too short nor at the ends of the format
  };

  // MeetTriangle. A product with −1 only changes the sign.
  HWY_INLINE Meeting Meet(const D3& origin, const D3& direction, const LaneTriangles& triangles) const {
    const Doubles d;
    const D zero = hn::Zero(d);
    const D3 from = {hn::Sub(origin.x, triangles.corner.x), hn::Sub(origin.y, triangles.corner.y),
                     hn::Sub(origin.z, triangles.corner.z)};
    const D3 moment = {hn::Sub(hn::Neg(from.y), hn::Mul(direction.y, from.z)),
                       hn::Add(hn::Mul(from.z, direction.x), from.x),
                       hn::Sub(hn::Mul(from.x, direction.y), hn::Mul(direction.x, from.y))};
    const D along = hn::Sub(hn::Add(hn::Mul(triangles.area.x, direction.x), hn::Mul(triangles.area.y, direction.y)),
                            triangles.area.z);
    const D scale = hn::Div(hn::Set(d, -1.0), along);
    const D v = hn::Mul(Dot(triangles.second_edge, moment), scale);
    const D w = hn::Mul(Dot(triangles.first_edge, moment), scale);
    const auto inside = hn::And(hn::And(hn::Ge(v, zero), hn::Ge(w, zero)), hn::Le(hn::Add(v, w), hn::Set(d, 1.0)));
    const auto steady = hn::Gt(hn::Abs(along), hn::Mul(triangles.edge_on, hn::Set(d, longest_ray_)));
    return {along, v, w, hn::Not(hn::And(inside, steady))};
  }

  // ObjectNormal, and its transform into view space. `side`: −0 where the back is seen, else 0.
  HWY_INLINE ViewNormal NormalAt(const Meeting& meeting, const LaneTriangles& triangles, const LaneObjects& objects,
                                 D side) const {
    const Doubles d;
    const Floats f;
    const F fv = hn::DemoteTo(f, meeting.v);
    const F fw = hn::DemoteTo(f, meeting.w);
    const F fu = hn::Sub(hn::Sub(hn::Set(f, 1.0f), fv), fw);
    const auto interpolate = [&](int axis) {
      const F sum_of_two = hn::Add(hn::Mul(triangles.normal[axis], fu), hn::Mul(triangles.normal[3 + axis], fv));
      return hn::PromoteTo(d, hn::Add(sum_of_two, hn::Mul(triangles.normal[6 + axis], fw)));
    };
    const D3 normal = {interpolate(0), interpolate(1), interpolate(2)};
    const auto usable = hn::Gt(Dot(normal, normal), hn::Set(d, kShortestNormal * kShortestNormal));
    const auto turn = [&](D a, D b, D c) {
      const D turned = hn::Add(hn::Add(hn::Mul(a, normal.x), hn::Mul(b, normal.y)), hn::Mul(c, normal.z));
      return hn::Xor(turned, side);
    };
    const D3 shading = {turn(objects.column[0].x, objects.column[1].x, objects.column[2].x),
                        turn(objects.column[0].y, objects.column[1].y, objects.column[2].y),
                        turn(objects.column[0].z, objects.column[1].z, objects.column[2].z)};
    const D squared = Dot(shading, shading);
    const auto ordinary =
        hn::And(hn::Gt(squared, hn::Set(d, kLeastPlainSquare)), hn::Lt(squared, hn::Set(d, kLargestPlainSquare)));
    return {shading, squared, hn::And(usable, ordinary)};
  }

  // Stores what MakeUnits reads, and the guides that are ready. `met`: a surface is there.
  HWY_INLINE void StoreSurface(std::size_t pixel, Mask met, D z, const ViewNormal& normal, const LaneObjects& objects) {
    const Doubles d;
    const Floats f;
    const D infinity = hn::Set(d, std::numeric_limits<double>::infinity());
    const D depth = hn::IfThenElse(met, ZeroAtLeast(hn::Neg(z)), infinity);
    hn::Store(hn::DemoteTo(f, depth), f, guides_.depth.data() + pixel);
    // The square root and its division depend on each other only, so they are done in a loop of their own.
    hn::Store(hn::IfThenElseZero(met, normal.shading.x), d, shading_[0] + pixel);
    hn::Store(hn::IfThenElseZero(met, normal.shading.y), d, shading_[1] + pixel);
    hn::Store(hn::IfThenElseZero(met, normal.shading.z), d, shading_[2] + pixel);
    hn::Store(hn::IfThenElse(met, normal.squared, hn::Set(d, 1.0)), d, squared_ + pixel);
    work_[work_count_++] = std::uint8_t(pixel);
    const auto empty = SameObject(pixel, TileHits::kNothing);
    hn::Store(hn::IfThenZeroElse(empty, objects.object_id), f, guides_.object.data() + pixel);
    hn::Store(hn::IfThenZeroElse(empty, objects.material_id), f, guides_.material.data() + pixel);
  }

  template <bool kPoints>
  HWY_INLINE void Lanes(std::size_t pixel) {
    const Doubles d;
    const Keys k;
    // Embree's id of a miss makes the upper half of the key all ones, which no object has.
    const auto keys = hn::Load(k, keys_ + pixel);
    const auto met = hn::Lt(keys, hn::Set(k, std::uint64_t(TileHits::kNothing) << 32));
    if (hn::AllFalse(k, met)) return StoreBackground(pixel);

    LaneTriangles triangles;
    auto irregular = hn::FirstN(d, 0);
    bool one_object = true;
    const std::uint32_t first_object = FindTriangles<kPoints>(pixel, keys, met, triangles, irregular, one_object);
    LaneObjects objects;
    objects.SetAllTo(triangles_.objects()[first_object]);
    if (!one_object) BlendObjects(pixel, keys, met, objects);

    const D zero = hn::Zero(d);
    const D across = hn::Load(d, rays_.across[pixel / kSquarePixels % kTileSquares] + pixel % 8);
    const D up = hn::Load(d, rays_.up[pixel / 64 * 2 + pixel % kSquarePixels / 8] + pixel % 8);
    const D3 origin = rays_.orthographic ? D3{across, up, zero} : D3{zero, zero, zero};
    const D3 direction = rays_.orthographic ? D3{zero, zero, hn::Set(d, -1.0)} : D3{across, up, hn::Set(d, -1.0)};

    const Meeting meeting = Meet(origin, direction, triangles);
    const D z = meeting.Mix(triangles.corner.z, triangles.first_edge.z, triangles.second_edge.z);
    // A product with 1 or −1 is done as a change of sign, which is cheaper.
    const D minus = hn::Set(d, -0.0);
    const auto back = hn::Gt(hn::Xor(meeting.along, hn::And(objects.winding, minus)), zero);
    const D side = hn::IfThenElseZero(back, minus);
    const ViewNormal normal = NormalAt(meeting, triangles, objects, side);

    const auto met_double = hn::RebindMask(d, met);
    auto plain = hn::Or(hn::Or(irregular, meeting.missed), hn::Not(normal.ordinary));
    if (bends_normals_) {
      const D to_eye = hn::Neg(Dot(normal.shading, direction));
      const D to_facing = hn::Xor(Dot(normal.shading, triangles.area), hn::Xor(hn::And(objects.winding, minus), side));
      const D eye_height = hn::Mul(hn::Abs(meeting.along), normal.squared);
      const auto above = MirrorsAbove(to_eye, to_facing, eye_height, hn::Mul(triangles.area_length, normal.squared));
      plain = hn::Or(plain, hn::Not(above));
    }
    const auto left_over = hn::And(plain, met_double);
    if (HWY_UNLIKELY(!hn::AllFalse(d, left_over))) LeaveOver(pixel, left_over);

    StoreSurface(pixel, met_double, z, normal, objects);
    if constexpr (kPoints) {
      const D3 position = {meeting.Mix(triangles.corner.x, triangles.first_edge.x, triangles.second_edge.x),
                           meeting.Mix(triangles.corner.y, triangles.first_edge.y, triangles.second_edge.y), z};
      StorePoints(pixel, meeting.v, meeting.w, position, hn::Xor(objects.winding, side), triangles);
    }
  }

  // Whether the plain code would surely not bend the normal: BentNormal's test times the squared length of the normal
  // and the lengths of the triangle's area and of the ray, with a margin for rounding. False for NaN.
  HWY_INLINE Mask MirrorsAbove(D to_eye, D to_facing, D eye_height, D scale) const {
    constexpr double kMargin = 1.001;
    const Doubles d;
    const D mirrored = hn::Sub(hn::Mul(hn::Set(d, 2.0), hn::Mul(to_eye, to_facing)), eye_height);
    const auto steep = hn::Ge(mirrored, hn::Mul(eye_height, hn::Set(d, kMargin * kReflectionShare)));
    return hn::Or(steep, hn::Ge(mirrored, hn::Mul(scale, hn::Set(d, kMargin * kReflectionHeight * longest_ray_))));
  }

  // MakeUnit for ordinary squares.
  template <bool kPoints>
  HWY_INLINE void MakeUnits(std::size_t pixel) {
    const Doubles d;
    const Floats f;
    const D inverse = hn::Div(hn::Set(d, 1.0), hn::Sqrt(hn::Load(d, squared_ + pixel)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const D unit = hn::Mul(hn::Load(d, shading_[axis] + pixel), inverse);
      hn::Store(hn::DemoteTo(f, unit), f, guides_.normal[axis].data() + pixel);
      if constexpr (kPoints) hn::Store(unit, d, points_->normal[axis].data() + pixel);
    }
  }

  // The triangles of the lanes that met one. Returns the first one's object. `irregular`: lanes that are left to the
  // plain code.
  template <bool kPoints, class V, class M>
  HWY_INLINE std::uint32_t FindTriangles(std::size_t pixel, V keys, M met, LaneTriangles& triangles, Mask& irregular,
                                         bool& one_object) {
    const Doubles d;
    const Keys k;
    std::size_t lane = std::size_t(hn::FindFirstTrue(k, met));
    const std::uint32_t first_object = hits_.object[pixel + lane];
    {
      const TriangleRecord& record = triangles_.Find(first_object, hits_.primitive[pixel + lane]);
      triangles.SetAllTo<kPoints>(record);
      if (!record.regular) irregular = hn::RebindMask(d, hn::Eq(keys, hn::Set(k, keys_[pixel + lane])));
    }
    auto left = hn::AndNot(hn::Eq(keys, hn::Set(k, keys_[pixel + lane])), met);
    while (!hn::AllFalse(k, left)) {
      lane = std::size_t(hn::FindFirstTrue(k, left));
      const std::uint32_t object = hits_.object[pixel + lane];
      const std::uint32_t primitive = hits_.primitive[pixel + lane];
      one_object = one_object && object == first_object;
      const auto same = hn::Eq(keys, hn::Set(k, keys_[pixel + lane]));
      left = hn::AndNot(same, left);
      const TriangleRecord& record = triangles_.Find(object, primitive);
      triangles.SetSome<kPoints>(hn::RebindMask(d, same), SameTriangle(pixel, object, primitive), record);
      if (!record.regular) irregular = hn::Or(irregular, hn::RebindMask(d, same));
    }
    return first_object;
  }

  template <class V, class M>
  HWY_INLINE void BlendObjects(std::size_t pixel, V keys, M met, LaneObjects& objects) {
    const Keys k;
    const auto numbers = hn::ShiftRight<32>(keys);
    for (auto left = met; !hn::AllFalse(k, left);) {
      const std::uint32_t object = hits_.object[pixel + std::size_t(hn::FindFirstTrue(k, left))];
      const auto same = hn::Eq(numbers, hn::Set(k, object));
      left = hn::AndNot(same, left);
      objects.SetSome(hn::RebindMask(Doubles(), same), SameObject(pixel, object), triangles_.objects()[object]);
    }
  }

  // What light is found at: the places that the rays met. `sign` turns a triangle's normal to the eye.
  HWY_INLINE void StorePoints(std::size_t pixel, D v, D w, const D3& position, D sign, const LaneTriangles& triangles) {
    const Doubles d;
    hn::Store(v, d, points_->barycentric[0].data() + pixel);
    hn::Store(w, d, points_->barycentric[1].data() + pixel);
    StorePoint(position, points_->position, pixel);
    StorePoint(
        {hn::Mul(triangles.facing.x, sign), hn::Mul(triangles.facing.y, sign), hn::Mul(triangles.facing.z, sign)},
        points_->facing, pixel);
    const D own = Magnitude(position);
    const D largest = hn::IfThenElse(hn::Lt(own, triangles.largest), triangles.largest, own);
    hn::Store(largest, d, points_->largest_coordinate.data() + pixel);
  }

  HWY_INLINE void StorePoint(const D3& v, std::array<std::array<double, kTilePixels>, 3>& to, std::size_t pixel) {
    hn::Store(v.x, Doubles(), to[0].data() + pixel);
    hn::Store(v.y, Doubles(), to[1].data() + pixel);
    hn::Store(v.z, Doubles(), to[2].data() + pixel);
  }

  const TileHits& hits_;
  const LaneRays rays_;
  const double longest_ray_;
  const bool bends_normals_;
  TriangleCache& triangles_;
  TileGuides& guides_;
  TilePoints* points_;
  alignas(64) std::uint64_t keys_[kTilePixels];
  alignas(64) double shading_[3][kTilePixels];  // before it has unit length
  alignas(64) double squared_[kTilePixels];     // its length
  std::uint8_t work_[kTilePixels];              // first pixels of the lanes that met something
  std::size_t work_count_ = 0;
};

void Surface(const TileHits& hits, const TileRays& rays, TriangleCache& triangles, bool bends_normals,
             TileGuides& guides, TilePoints* points) {
  TileWork work(hits, rays, triangles, bends_normals, guides, points);
  if (points) {
    work.Run<true>();
  } else {
    work.Run<false>();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace scumble
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble {

HWY_EXPORT(Surface);

void FindTileSurface(const TileHits& hits, const TileRays& rays, TriangleCache& triangles, bool bends_normals,
                     TileGuides& guides, TilePoints* points) {
  if (points) points->has_smooth_normal.fill(false);
  HWY_DYNAMIC_DISPATCH(Surface)(hits, rays, triangles, bends_normals, guides, points);
}

SurfacePoint TilePoints::At(int pixel) const {
  const auto i = std::size_t(pixel);
  SurfacePoint point;
  point.position = {position[0][i], position[1][i], position[2][i]};
  point.facing = {facing[0][i], facing[1][i], facing[2][i]};
  point.normal = {normal[0][i], normal[1][i], normal[2][i]};
  point.barycentric = {barycentric[0][i], barycentric[1][i]};
  point.largest_coordinate = largest_coordinate[i];
  if (has_smooth_normal[i]) point.smooth_normal = smooth_normal[i];
  return point;
}

void TilePoints::Set(int pixel, const SurfacePoint& point) {
  const auto i = std::size_t(pixel);
  for (int axis = 0; axis < 3; ++axis) {
    position[axis][i] = point.position[axis];
    facing[axis][i] = point.facing[axis];
    normal[axis][i] = point.normal[axis];
  }
  for (int k = 0; k < 2; ++k) barycentric[k][i] = point.barycentric[k];
  largest_coordinate[i] = point.largest_coordinate;
  has_smooth_normal[i] = true;
  smooth_normal[i] = point.smooth_normal;
}

}  // namespace scumble
#endif
