#include "measure/flip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <numbers>
#include <string>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/io/parallel.h"
#include "measure/compare/on_white.h"

namespace scumble {
namespace {

using std::numbers::pi;

// The paper's constants, by its names.
constexpr double kQc = 0.7, kPc = 0.4, kPt = 0.95, kQf = 0.5, kW = 0.082;

// ---- Colours ----

// XYZ of the colour with chromaticity (x, y) and luminance 1.
glm::dvec3 FromChromaticity(double x, double y) { return {x / y, 1.0, (1.0 - x - y) / y}; }

// XYZ of linear Rec.709, from the chromaticities of its primaries and of D65 as IEC 61966-2-1 has them.
struct Rec709 {
  glm::dmat3 xyz_from_rgb;
  glm::dmat3 rgb_from_xyz;
  glm::dvec3 white;

  Rec709() {
    white = FromChromaticity(0.3127, 0.3290);
    const glm::dmat3 primaries(FromChromaticity(0.64, 0.33), FromChromaticity(0.30, 0.60),
                               FromChromaticity(0.15, 0.06));
    const glm::dvec3 luminances = glm::inverse(primaries) * white;
    for (int c = 0; c < 3; ++c) xyz_from_rgb[c] = primaries[c] * luminances[c];
    rgb_from_xyz = glm::inverse(xyz_from_rgb);
  }
};

const Rec709& Space() {
  static const Rec709 space;
  return space;
}

// The opponent space that is linear in light: Y, Cx, Cz.
glm::dvec3 OpponentFromLinear(glm::dvec3 rgb) {
  const glm::dvec3 xyz = Space().xyz_from_rgb * rgb / Space().white;
  return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}

glm::dvec3 LinearFromOpponent(glm::dvec3 opponent) {
  const double y = (opponent.x + 16.0) / 116.0;
  return Space().rgb_from_xyz * (glm::dvec3(y + opponent.y / 500.0, y, y - opponent.z / 200.0) * Space().white);
}

double LabCurve(double t) {
  constexpr double kDelta = 6.0 / 29.0;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

// L*a*b* with the Hunt adjustment: dark colours have less chroma.
glm::dvec3 HuntLabFromLinear(glm::dvec3 rgb) {
  const glm::dvec3 xyz = Space().xyz_from_rgb * rgb / Space().white;
  const double fx = LabCurve(xyz.x), fy = LabCurve(xyz.y), fz = LabCurve(xyz.z), lightness = 116.0 * fy - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (fx - fy), 0.01 * lightness * 200.0 * (fy - fz)};
}

double Hyab(glm::dvec3 a, glm::dvec3 b) {
  const glm::dvec3 d = a - b;
  return std::fabs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// The largest difference there is in the gamut, raised to q_c: that of green and blue.
double LargestDifference() {
  static const double largest =
      std::pow(Hyab(HuntLabFromLinear({0.0, 1.0, 0.0}), HuntLabFromLinear({0.0, 0.0, 1.0})), kQc);
  return largest;
}

// Differences up to p_c of the largest are mapped to p_t of the range.
double ColorError(glm::dvec3 reference, glm::dvec3 test) {
  const double error = std::pow(Hyab(reference, test), kQc), largest = LargestDifference(), knee = kPc * largest;
  return error < knee ? kPt / knee * error : kPt + (error - knee) / (largest - knee) * (1.0 - kPt);
}

// ---- Filters: all are separable, and stored as the weights of −r … r ----

using Weights = std::vector<double>;

double Sum(const Weights& weights) {
  double sum = 0.0;
  for (const double w : weights) sum += w;
  return sum;
}

// exp(−π² x² / b) at x degrees; b in square degrees.
Weights SensitivityGaussian(double b, int radius, double pixels_per_degree) {
  Weights weights;
  for (int i = -radius; i <= radius; ++i) {
    const double x = i / pixels_per_degree;
    weights.push_back(std::exp(-pi * pi * x * x / b));
  }
  return weights;
}

Weights Scaled(Weights weights, double factor) {
  for (double& w : weights) w *= factor;
  return weights;
}

// Positive weights sum to 1 and negative ones to −1.
Weights Balanced(Weights weights) {
  double positive = 0.0, negative = 0.0;
  for (const double w : weights) (w > 0.0 ? positive : negative) += w;
  for (double& w : weights) w /= w > 0.0 ? positive : -negative;
  return weights;
}

struct Filters {
  Weights y, cx;              // contrast sensitivity: luminance, red–green
  Weights cz[2];              // blue–yellow is the sum of two Gaussians
  Weights blur, edge, point;  // features: a Gaussian and its first two derivatives

  explicit Filters(double pixels_per_degree) {
    constexpr double kLuminance = 0.0047, kRedGreen = 0.0053, kBlueYellow[2] = {0.04, 0.025}, kAmount[2] = {34.1, 13.5};
    const int radius =
        static_cast<int>(std::ceil(3.0 * std::sqrt(kBlueYellow[0] / (2.0 * pi * pi)) * pixels_per_degree));
    y = SensitivityGaussian(kLuminance, radius, pixels_per_degree);
    cx = SensitivityGaussian(kRedGreen, radius, pixels_per_degree);
    y = Scaled(y, 1.0 / Sum(y)), cx = Scaled(cx, 1.0 / Sum(cx));
    double total = 0.0, amount[2];
    for (int i = 0; i < 2; ++i) {
      cz[i] = SensitivityGaussian(kBlueYellow[i], radius, pixels_per_degree);
      amount[i] = kAmount[i] * std::sqrt(pi / kBlueYellow[i]);
      total += amount[i] * Sum(cz[i]) * Sum(cz[i]);
    }
    for (int i = 0; i < 2; ++i) cz[i] = Scaled(cz[i], std::sqrt(amount[i] / total));

    const double sigma = 0.5 * kW * pixels_per_degree;
    const int reach = static_cast<int>(std::ceil(3.0 * sigma));
    for (int i = -reach; i <= reach; ++i) {
      const double g = std::exp(-0.5 * i * i / (sigma * sigma));
      blur.push_back(g), edge.push_back(-i * g), point.push_back((i * i / (sigma * sigma) - 1.0) * g);
    }
    blur = Scaled(blur, 1.0 / Sum(blur)), edge = Balanced(edge), point = Balanced(point);
  }
};

// ---- One picture ----

struct Plane {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  Plane(int w, int h) : width(w), height(h), values(std::size_t(w) * h) {}
  const float* Row(int y) const { return values.data() + std::size_t(y) * width; }
  float* Row(int y) { return values.data() + std::size_t(y) * width; }
};

// Rows, then columns; sums of doubles in the order of the weights, whatever the threads.
Plane Filtered(const Plane& plane, const Weights& across, const Weights& down, int threads) {
  const int width = plane.width, height = plane.height, reach = static_cast<int>(across.size()) / 2;
  SCUMBLE_CHECK_EQ(across.size(), down.size());
  Plane rows(width, height), out(width, height);
  internal::ForEachIndex(height, threads, [&](int y) {
    std::vector<float> padded(std::size_t(width) + 2 * reach);
    for (int i = 0; i < static_cast<int>(padded.size()); ++i) {
      padded[std::size_t(i)] = plane.Row(y)[std::clamp(i - reach, 0, width - 1)];
    }
    std::vector<double> sums(std::size_t(width), 0.0);
    for (std::size_t k = 0; k < across.size(); ++k) {
      for (int x = 0; x < width; ++x) sums[std::size_t(x)] += across[k] * padded[std::size_t(x) + k];
    }
    std::copy(sums.begin(), sums.end(), rows.Row(y));
  });
  internal::ForEachIndex(height, threads, [&](int y) {
    std::vector<double> sums(std::size_t(width), 0.0);
    for (int k = -reach; k <= reach; ++k) {
      const float* row = rows.Row(std::clamp(y + k, 0, height - 1));
      for (int x = 0; x < width; ++x) sums[std::size_t(x)] += down[std::size_t(k + reach)] * row[x];
    }
    std::copy(sums.begin(), sums.end(), out.Row(y));
  });
  return out;
}

// A picture as the eye filters it.
struct Seen {
  Plane lightness, a, b;  // blurred, in Hunt-adjusted L*a*b*
  Plane edges, points;    // 0 … √2

  Seen(const LinearColors& colors, const Filters& filters, int threads)
      : lightness(colors.width, colors.height),
        a(colors.width, colors.height),
        b(colors.width, colors.height),
        edges(colors.width, colors.height),
        points(colors.width, colors.height) {
    Plane y(colors.width, colors.height), cx = y, cz = y, bright = y;
    for (std::size_t i = 0; i < y.values.size(); ++i) {
      const glm::dvec3 opponent = OpponentFromLinear({colors.planes[0][i], colors.planes[1][i], colors.planes[2][i]});
      y.values[i] = static_cast<float>(opponent.x), cx.values[i] = static_cast<float>(opponent.y);
      cz.values[i] = static_cast<float>(opponent.z), bright.values[i] = static_cast<float>((opponent.x + 16.0) / 116.0);
    }
    SetFeatures(bright, filters, threads);
    y = Filtered(y, filters.y, filters.y, threads);
    cx = Filtered(cx, filters.cx, filters.cx, threads);
    const Plane wide = Filtered(cz, filters.cz[0], filters.cz[0], threads);
    const Plane narrow = Filtered(cz, filters.cz[1], filters.cz[1], threads);
    internal::ForEachIndex(y.height, threads, [&](int row) {
      const std::size_t end = std::size_t(row + 1) * y.width;
      for (std::size_t i = std::size_t(row) * y.width; i < end; ++i) {
        const double blue_yellow = double(wide.values[i]) + narrow.values[i];
        const glm::dvec3 rgb = glm::clamp(LinearFromOpponent({y.values[i], cx.values[i], blue_yellow}), 0.0, 1.0);
        const glm::dvec3 lab = HuntLabFromLinear(rgb);
        lightness.values[i] = static_cast<float>(lab.x);
        a.values[i] = static_cast<float>(lab.y), b.values[i] = static_cast<float>(lab.z);
      }
    });
  }

  glm::dvec3 Lab(std::size_t i) const { return {lightness.values[i], a.values[i], b.values[i]}; }

 private:
  void SetFeatures(const Plane& bright, const Filters& filters, int threads) {
    const auto set_lengths = [&](const Weights& derivative, Plane& lengths) {
      const Plane across = Filtered(bright, derivative, filters.blur, threads);
      const Plane down = Filtered(bright, filters.blur, derivative, threads);
      for (std::size_t i = 0; i < lengths.values.size(); ++i) {
        lengths.values[i] = static_cast<float>(
            std::sqrt(double(across.values[i]) * across.values[i] + double(down.values[i]) * down.values[i]));
      }
    };
    set_lengths(filters.edge, edges), set_lengths(filters.point, points);
  }
};

FlipReport Flip(const LinearColors& reference, const LinearColors& test, const FlipOptions& options) {
  const Filters filters(options.pixels_per_degree);
  const Seen r(reference, filters, options.threads), t(test, filters, options.threads);
  FlipReport report{.width = reference.width, .height = reference.height, .map = {}};
  report.map.resize(r.edges.values.size());
  internal::ForEachIndex(reference.height, options.threads, [&](int row) {
    const std::size_t end = std::size_t(row + 1) * reference.width;
    for (std::size_t i = std::size_t(row) * reference.width; i < end; ++i) {
      const double feature = std::max(std::fabs(double(r.edges.values[i]) - t.edges.values[i]),
                                      std::fabs(double(r.points.values[i]) - t.points.values[i]));
      const double raised = std::pow(feature / std::numbers::sqrt2, kQf);
      report.map[i] = static_cast<float>(std::pow(ColorError(r.Lab(i), t.Lab(i)), 1.0 - raised));
    }
  });
  for (const float value : report.map) report.mean += value, report.max = std::max(report.max, double(value));
  report.mean /= static_cast<double>(report.map.size());
  return report;
}

double RootMeanSquare(const LinearColors& a, const LinearColors& b) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < a.planes[c].size(); ++i) {
      const double d = double(a.planes[c][i]) - b.planes[c][i];
      sum += d * d;
    }
  }
  return std::sqrt(sum / (3.0 * static_cast<double>(a.planes[0].size())));
}

Status CheckInputs(int width, int height, int test_width, int test_height, const FlipOptions& options) {
  if (width != test_width || height != test_height) {
    return InputError("the reference is " + std::to_string(width) + "×" + std::to_string(height) +
                      ", the other picture " + std::to_string(test_width) + "×" + std::to_string(test_height) +
                      ": FLIP compares pictures of one size");
  }
  if (width == 0 || height == 0) return InputError("the pictures are empty: FLIP compares at least one pixel");
  if (!(options.pixels_per_degree > 0.0 && options.pixels_per_degree <= 1000.0)) {
    return UsageError("pixels per degree are " + std::to_string(options.pixels_per_degree) +
                      ": expected more than 0 and at most 1000; 67 is a 4K display at arm's length");
  }
  return Ok();
}

LinearColors Clamped(LinearColors colors) {
  for (std::vector<float>& plane : colors.planes) {
    SCUMBLE_CHECK_EQ(plane.size(), std::size_t(colors.width) * colors.height);
    for (float& value : plane) value = value > 0.0f ? std::min(value, 1.0f) : 0.0f;  // NaN is not above 0
  }
  return colors;
}

LinearColors EncodedOnWhite(const Picture& picture) {
  LinearColors colors{picture.width, picture.height, {}};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto color = OnWhite(picture, x, y);
      for (std::size_t c = 0; c < 3; ++c) colors.planes[c].push_back(static_cast<float>(color[c]));
    }
  }
  return colors;
}

LinearColors Decoded(LinearColors colors) {
  for (std::vector<float>& plane : colors.planes) {
    for (float& value : plane) value = SrgbToLinear(value);
  }
  return colors;
}

}  // namespace

Expected<FlipReport> MeasureFlip(const Picture& reference, const Picture& test, const FlipOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(reference.width, reference.height, test.width, test.height, options));
  LinearColors a = EncodedOnWhite(reference), b = EncodedOnWhite(test);
  const double rms = RootMeanSquare(a, b);
  a = Decoded(std::move(a)), b = Decoded(std::move(b));
  FlipReport report = Flip(a, b, options);
  report.rms = rms;
  return report;
}

Expected<FlipReport> MeasureFlip(const LinearColors& reference, const LinearColors& test, const FlipOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckInputs(reference.width, reference.height, test.width, test.height, options));
  const LinearColors a = Clamped(reference), b = Clamped(test);
  FlipReport report = Flip(a, b, options);
  report.rms = RootMeanSquare(a, b);
  return report;
}

}  // namespace scumble
