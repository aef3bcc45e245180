#include "core/style/scan/paper_light.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/color.h"
#include "core/style/scan/homography.h"

namespace scumble {
namespace {

constexpr int kTerms = 6;
using Terms = std::array<double, kTerms>;

Terms TermsAt(glm::dvec2 p) {
  const double x = p.x - 0.5, y = p.y - 0.5;
  return {1, x, y, x * x, x * y, y * y};
}

double Sum(const Terms& coefficients, const Terms& terms) {
  double sum = 0;
  for (int i = 0; i < kTerms; ++i) sum += coefficients[i] * terms[i];
  return sum;
}

// A place of the template and the mean light there.
struct Patch {
  glm::dvec2 at;
  glm::dvec3 light;
  bool clipped;
};

// The mean over the middle half of one module at `at`, from the pixels there, of which a fine scan has many.
std::optional<Patch> PatchAt(const Picture& picture, const TemplateMap& map, glm::dvec2 at) {
  constexpr int kPoints = 5;
  Patch patch{at, glm::dvec3(0.0), false};
  int clipped = 0;
  for (int i = 0; i < kPoints * kPoints; ++i) {
    const glm::dvec2 off(i % kPoints - kPoints / 2, i / kPoints - kPoints / 2);
    const glm::dvec2 p = map.ToPicture(at + off * (0.1 * kFiducialModule));
    if (!(p.x >= 0 && p.y >= 0 && p.x < picture.width && p.y < picture.height)) return std::nullopt;
    const std::uint16_t* pixel = picture.At(int(p.x), int(p.y));
    for (int c = 0; c < 3; ++c) patch.light[c] += double(Srgb16ToLinear(pixel[c])) / (kPoints * kPoints);
    clipped += std::max({pixel[0], pixel[1], pixel[2]}) >= 65000;
  }
  patch.clipped = 2 * clipped > kPoints * kPoints;
  return patch;
}

// Whether most modules around are black too: then a blurred scan mixes in little of the white.
bool AmidBlack(int id, int column, int row) {
  int black = 0;
  for (int k = 0; k < 9; ++k) {
    const int c = column + k % 3 - 1, r = row + k / 3 - 1;
    const bool inside = std::min(c, r) >= 0 && std::max(c, r) < kFiducialModules;
    black += inside && FiducialIsBlack(id, c, r);
  }
  return black >= 5;
}

// Collects places of paper that is bare unless somebody painted on it, and places of printed black.
void CollectPatches(const Picture& picture, const TemplateFit& fit, std::vector<Patch>& white,
                    std::vector<Patch>& black) {
  const auto take = [&](glm::dvec2 at, std::vector<Patch>& patches) {
    if (const auto patch = PatchAt(picture, fit.map, at)) patches.push_back(*patch);
  };
  for (const FoundMark& found : fit.marks) {
    const Fiducial& mark = Fiducials()[std::size_t(found.id)];
    for (int row = -1; row <= kFiducialModules; ++row) {
      for (int column = -1; column <= kFiducialModules; ++column) {
        const bool outside = std::min(row, column) < 0 || std::max(row, column) >= kFiducialModules;
        const glm::dvec2 at = glm::dvec2(mark.left, mark.top) + glm::dvec2(column + 0.5, row + 0.5) * kFiducialModule;
        if (outside || !FiducialIsBlack(mark.id, column, row))
          take(at, white);
        else if (AmidBlack(mark.id, column, row))
          take(at, black);
      }
    }
  }
  // The margin's outer half, away from paint that runs over the square's sides, without the marks.
  constexpr double kStep = 1.0 / 32;
  for (double y = -kFiducialMargin + kStep / 2; y < 1 + kFiducialMargin; y += kStep) {
    for (double x = -kFiducialMargin + kStep / 2; x < 1 + kFiducialMargin; x += kStep) {
      const double in = kFiducialMargin / 2;
      if (x > -in && x < 1 + in && y > -in && y < 1 + in) continue;
      const bool on_mark = std::any_of(Fiducials().begin(), Fiducials().end(), [&](const Fiducial& mark) {
        const double near = kFiducialQuiet + kFiducialModule;
        return x > mark.left - near && x < mark.left + kFiducialSide + near && y > mark.top - near &&
               y < mark.top + kFiducialSide + near;
      });
      if (!on_mark) take({x, y}, white);
    }
  }
}

Terms FitWeighted(const std::vector<Patch>& patches, const std::vector<double>& weights, int channel) {
  std::array<double, kTerms * kTerms> a{};
  Terms b{};
  double all = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Terms terms = TermsAt(patches[i].at);
    const double value = std::log(std::max(1e-4, patches[i].light[channel]));
    for (int r = 0; r < kTerms; ++r) {
      for (int c = 0; c < kTerms; ++c) a[std::size_t(r * kTerms + c)] += weights[i] * terms[r] * terms[c];
      b[r] += weights[i] * terms[r] * value;
    }
    all += weights[i];
  }
  // A weak pull towards even light, where the remaining marks leave a curve undetermined.
  for (int r = 1; r < kTerms; ++r) a[std::size_t(r * kTerms + r)] += 1e-5 * all;
  if (!(all > 0) || !SolveLinear(a.data(), b.data(), kTerms)) return {};
  return b;
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Differences from the fit in log light, in the channel where a place is darkest: coloured paint may be as bright as
// paper in one channel.
std::vector<double> DarkestDifferences(const std::vector<Patch>& white, const std::array<Terms, 3>& fit) {
  std::vector<double> differences;
  for (const Patch& patch : white) {
    const Terms terms = TermsAt(patch.at);
    double least = 1e9;
    for (int c = 0; c < 3; ++c) least = std::min(least, std::log(std::max(1e-4, patch.light[c])) - Sum(fit[c], terms));
    differences.push_back(least);
  }
  return differences;
}

}  // namespace

glm::dvec3 PaperLight::White(glm::dvec2 on_template) const {
  const Terms terms = TermsAt(on_template);
  glm::dvec3 white;
  for (int c = 0; c < 3; ++c) white[c] = std::exp(Sum(log_white[c], terms));
  return white;
}

double PaperLight::Unevenness() const {
  double least = 1e9, most = 0;
  for (int i = 0; i < 17 * 17; ++i) {
    const glm::dvec2 at = glm::dvec2(i % 17, i / 17) / 16.0 * (1 + 2 * kFiducialMargin) - kFiducialMargin;
    const glm::dvec3 white = White(at);
    const double light = Luminance(float(white.r), float(white.g), float(white.b));
    least = std::min(least, light), most = std::max(most, light);
  }
  return most > 0 ? 1 - least / most : 0;
}

PaperLight MeasurePaperLight(const Picture& picture, const TemplateFit& fit) {
  std::vector<Patch> white, black;
  CollectPatches(picture, fit, white, black);
  PaperLight light;
  std::vector<double> weights(white.size(), 1.0), differences;
  const auto refit = [&] {
    for (int c = 0; c < 3; ++c) light.log_white[c] = FitWeighted(white, weights, c);
    differences = DarkestDifferences(white, light.log_white);
  };
  // First the upper side of the cloud: places darker than the fit have little weight. Then only places close to it.
  for (int round = 0; round < 12; ++round) {
    refit();
    for (std::size_t i = 0; i < white.size(); ++i) weights[i] = differences[i] > -0.005 ? 1.0 : 0.03;
  }
  double reach = 0;
  for (int round = 0; round < 12; ++round) {
    refit();
    std::vector<double> close;
    for (const double d : differences) {
      if (std::abs(d) < 0.15) close.push_back(std::abs(d));
    }
    // Grain and noise stay far below a tenth; a shadow's edge must not pass for them.
    reach = std::min(0.1, 0.015 + 4 * 1.4826 * Quantile(close, 0.5));
    for (std::size_t i = 0; i < white.size(); ++i) {
      const double t = differences[i] / reach;
      weights[i] = std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0.0;
    }
  }
  double bare = 0, clipped = 0;
  for (std::size_t i = 0; i < white.size(); ++i) {
    if (std::abs(differences[i]) < reach) bare += 1, clipped += white[i].clipped;
  }
  light.bare_share = white.empty() ? 0 : bare / double(white.size());
  light.clipped_share = bare > 0 ? clipped / bare : 0;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> shares;
    for (const Patch& patch : black) shares.push_back(patch.light[c] / std::max(1e-4, light.White(patch.at)[c]));
    light.black[std::size_t(c)] = std::clamp(Quantile(shares, 0.5), 0.0, 0.9);
  }
  return light;
}

}  // namespace scumble
