#include "core/io/blender/solve_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/image/hash.h"

namespace scumble {
namespace {

constexpr std::size_t kMinPixels = 64;
constexpr std::size_t kMaxSamples = 100000;
constexpr double kExactPixels = 0.02;   // a render at pixel centres reprojects as well as this
constexpr double kScatterPixels = 3.0;  // how far slight depth of field, or a pixel filter, may scatter samples
constexpr double kScatterRms = 1.0;
constexpr double kOutliers = 0.001;
constexpr double kFloatRounding = 0x1.0p-22;  // relative; a renderer's last steps lose two bits
constexpr const char* kMend =
    "; give the .camera file that blender_scripts/render_guides.py writes, with --camera FILE";

// One covered pixel: its place from the picture's middle, and its position and depth.
struct Sample {
  double u, v;  // pixels, right and down
  glm::dvec3 p;
  double z;
};

// Least squares by normal equations, for a handful of unknowns.
template <int N>
class LeastSquares {
 public:
  void Add(const std::array<double, N>& row, double target) {
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j <= i; ++j) matrix_[i][j] += row[i] * row[j];
      right_[i] += row[i] * target;
    }
  }

  // Cholesky; false where the equations are singular. Columns are first scaled to length 1.
  bool Solve(std::array<double, N>& x) const {
    std::array<std::array<double, N>, N> l{};
    std::array<double, N> scale{};
    for (int i = 0; i < N; ++i) {
      if (!(matrix_[i][i] > 0.0) || !std::isfinite(matrix_[i][i])) return false;
      scale[i] = 1.0 / std::sqrt(matrix_[i][i]);
    }
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum = matrix_[i][j] * scale[i] * scale[j];
        for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
        if (i == j && !(sum > 1e-13)) return false;
        l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
      }
    }
    for (int i = 0; i < N; ++i) {
      x[i] = right_[i] * scale[i];
      for (int k = 0; k < i; ++k) x[i] -= l[i][k] * x[k];
      x[i] /= l[i][i];
    }
    for (int i = N - 1; i >= 0; --i) {
      for (int k = i + 1; k < N; ++k) x[i] -= l[k][i] * x[k];
      x[i] /= l[i][i];
    }
    for (int i = 0; i < N; ++i) x[i] *= scale[i];
    return true;
  }

 private:
  std::array<std::array<double, N>, N> matrix_{};
  std::array<double, N> right_{};
};

// The smallest eigenvalue of a symmetric matrix, by Jacobi's rotations.
double SmallestEigenvalue(glm::dmat3 m) {
  for (int sweep = 0; sweep < 30; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0.0) continue;
        const double angle = 0.5 * std::atan2(2.0 * m[p][q], m[q][q] - m[p][p]);
        glm::dmat3 turn(1.0);
        turn[p][p] = turn[q][q] = std::cos(angle);
        turn[p][q] = -std::sin(angle), turn[q][p] = std::sin(angle);
        m = glm::transpose(turn) * m * turn;
      }
    }
  }
  return std::min({m[0][0], m[1][1], m[2][2]});
}

std::string Number(double value, const char* format = "%.3g") {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

Error Refusal(const std::string& name, const std::string& why) {
  return InputError(name + " is a Blender render whose camera cannot be found from its Position pass: " + why + kMend);
}

// The solved view: z = Z_c + b·(p − centre), and u, v linear as the head of the header says.
struct View {
  glm::dvec3 right, up, back;  // rows of the rotation; the camera looks along −back
  glm::dvec3 centre;           // of the samples, in the world
  glm::dvec3 centre_in_view;
  double scale = 0.0;                   // focal length in pixels, or pixels a metre
  double shift_u = 0.0, shift_v = 0.0;  // of the principal point from the picture's middle, pixels
  bool orthographic = false;
  double rms = 0.0;  // of the samples, per axis

  glm::dvec3 InView(glm::dvec3 p) const {
    const glm::dvec3 d = p - centre;
    return centre_in_view + glm::dvec3(glm::dot(right, d), glm::dot(up, d), glm::dot(back, d));
  }
  glm::dvec2 Project(glm::dvec3 p) const {
    const glm::dvec3 q = InView(p);
    const double k = orthographic ? scale : scale / -q.z;
    return {shift_u + k * q.x, shift_v - k * q.y};
  }
};

class Solver {
 public:
  Solver(const SolveCameraInput& input, const std::string& name) : in_(input), name_(name) {}

  Expected<SolvedCamera> Run() {
    SCUMBLE_RETURN_IF_ERROR(TakeSamples());
    SCUMBLE_RETURN_IF_ERROR(FitDepth());
    const View perspective = FitView(false), orthographic = FitView(true);
    const View& view = orthographic.rms < perspective.rms ? orthographic : perspective;
    if (!std::isfinite(view.rms)) return Refusal(name_, "all that is seen lies in one plane" + plane_mend_);
    SolvedCamera result;
    SCUMBLE_RETURN_IF_ERROR(Prove(view, result));
    result.camera = ToCamera(view);
    result.orthographic = view.orthographic;
    return result;
  }

 private:
  bool Covered(int x, int y) const {
    const std::size_t i = std::size_t(y) * in_.width + x;
    return in_.depth[i] > 0.0f && in_.depth[i] < in_.background_depth && std::isfinite(in_.position[0][i]) &&
           std::isfinite(in_.position[1][i]) && std::isfinite(in_.position[2][i]);
  }

  Sample At(std::size_t i) const {
    const double x = static_cast<double>(i % in_.width), y = static_cast<double>(i / in_.width);
    return {x + 0.5 - 0.5 * in_.width,
            y + 0.5 - 0.5 * in_.height,
            {in_.position[0][i], in_.position[1][i], in_.position[2][i]},
            in_.depth[i]};
  }

  // Selects the pixels that count. Beside the background, a scattered sample counts only if it came to lie inside,
  // which would make the picture look larger than it is. So two pixels' distance is kept where enough others are left.
  Status TakeSamples() {
    const int width = in_.width, height = in_.height;
    std::vector<char> covered(std::size_t(width) * height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) covered[std::size_t(y) * width + x] = Covered(x, y);
    }
    std::vector<std::size_t> inside;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t i = std::size_t(y) * width + x;
        if (!covered[i]) continue;
        covered_.push_back(i);
        bool deep = true;
        for (int b = std::max(0, y - 2); deep && b <= std::min(height - 1, y + 2); ++b) {
          for (int a = std::max(0, x - 2); a <= std::min(width - 1, x + 2); ++a) {
            deep = deep && covered[std::size_t(b) * width + a];
          }
        }
        if (deep) inside.push_back(i);
      }
    }
    if (covered_.size() < kMinPixels) {
      return Refusal(name_, "only " + std::to_string(covered_.size()) + " pixels show anything, " +
                                std::to_string(kMinPixels) + " are needed");
    }
    constexpr std::size_t kEnoughInside = 1000;
    if (inside.size() >= kEnoughInside) covered_ = std::move(inside);
    // One pixel of each stretch, at a hashed place in it: a fixed step could hit one column again and again.
    const std::size_t count = std::min(covered_.size(), kMaxSamples);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t begin = covered_.size() * k / count, end = covered_.size() * (k + 1) / count;
      samples_.push_back(At(covered_[begin + Hash(k) % (end - begin)]));
    }
    return Ok();
  }

  // Finds b and the depth of the samples' centre; refuses samples that leave them undetermined.
  Status FitDepth() {
    glm::dvec3 sum(0.0);
    double largest = 0.0;
    for (const Sample& s : samples_) {
      sum += s.p;
      largest = std::max({largest, std::fabs(s.p.x), std::fabs(s.p.y), std::fabs(s.p.z)});
    }
    const double n = static_cast<double>(samples_.size());
    centre_ = sum / n;
    glm::dmat3 spread(0.0);
    for (const Sample& s : samples_) spread += glm::outerProduct(s.p - centre_, s.p - centre_) / n;
    const double extent = std::sqrt(spread[0][0] + spread[1][1] + spread[2][2]);
    const double thickness = std::sqrt(std::max(0.0, SmallestEigenvalue(spread)));
    LeastSquares<4> equations;
    for (const Sample& s : samples_) {
      const glm::dvec3 q = (s.p - centre_) / extent;
      equations.Add({q.x, q.y, q.z, 1.0}, s.z);
    }
    position_rounding_ = kFloatRounding * largest;
    std::array<double, 4> fit{};
    if (!(thickness > 1e-5 * extent) || !equations.Solve(fit)) {
      return Refusal(name_, "all that is seen lies in one plane" + plane_mend_);
    }
    const glm::dvec3 slope = glm::dvec3(fit[0], fit[1], fit[2]) / extent;
    double squares = 0.0, squared_depth = 0.0;
    std::size_t off = 0;
    for (const Sample& s : samples_) {
      const double error = s.z - (fit[3] + glm::dot(slope, s.p - centre_));
      squares += error * error, squared_depth += s.z * s.z;
      off += std::fabs(error) > 1e-4 * s.z + 4.0 * position_rounding_;
    }
    const double rounding = 0.25 * (position_rounding_ + kFloatRounding * std::sqrt(squared_depth / n));
    const double noise = std::max(std::sqrt(squares / n), rounding);
    if (static_cast<double>(off) > kOutliers * n) {
      return Refusal(
          name_, "its depth is not planar in " + Number(100.0 * static_cast<double>(off) / n) +
                     "% of the pixels, as with a panoramic camera, or Position and Depth that are not of one render");
    }
    if (noise > 0.01 * thickness || 4.0 * noise > 1e-4 * thickness * std::sqrt(n)) {
      return Refusal(name_, "all that is seen lies nearly in one plane (" + Number(thickness) +
                                " m thick, positions are "
                                "good to " +
                                Number(noise) + " m)" + plane_mend_);
    }
    const double length = glm::length(slope);
    if (std::fabs(length - 1.0) > 1e-3) {
      return Refusal(name_, "its depth grows by " + Number(length, "%.4f") +
                                " m a metre of the way; expected 1, planar "
                                "depth in the units of Position");
    }
    back_ = -slope / length;
    centre_depth_ = fit[3];
    return Ok();
  }

  // u·z = p·X + q·Y + a + cu·z and v·z = q·X − p·Y + b + cv·z. X and Y run along two directions across the view. An
  // orthographic view has no factor z. Divided by z, so that errors are pixels.
  View FitView(bool orthographic) const {
    const glm::dvec3 least = std::fabs(back_.y) < 0.7 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 e1 = glm::normalize(glm::cross(least, back_)), e2 = glm::cross(back_, e1);
    const double unit = orthographic ? 1.0 : centre_depth_;  // keeps the columns alike in size
    LeastSquares<6> perspective;
    LeastSquares<4> parallel;
    for (const Sample& s : samples_) {
      const glm::dvec3 d = s.p - centre_;
      const double k = orthographic ? 1.0 : unit / s.z;
      const double x = k * glm::dot(e1, d), y = k * glm::dot(e2, d);
      if (orthographic) {
        parallel.Add({x, y, 1, 0}, s.u);
        parallel.Add({-y, x, 0, 1}, s.v);
      } else {
        perspective.Add({x, y, k, 1, 0, 0}, s.u);
        perspective.Add({-y, x, 0, 0, k, 1}, s.v);
      }
    }
    View view;
    view.rms = INFINITY;
    view.orthographic = orthographic;
    view.back = back_, view.centre = centre_;
    double p, q, a, b;
    if (orthographic) {
      std::array<double, 4> fit{};
      if (!parallel.Solve(fit)) return view;
      p = fit[0], q = fit[1], a = fit[2], b = fit[3];
    } else {
      std::array<double, 6> fit{};
      if (!perspective.Solve(fit)) return view;
      p = fit[0] * unit, q = fit[1] * unit, a = fit[2] * unit, b = fit[4] * unit;
      view.shift_u = fit[3], view.shift_v = fit[5];
    }
    view.scale = std::hypot(p, q);
    if (!(view.scale > 0.0)) return view;
    view.right = (p * e1 + q * e2) / view.scale;
    view.up = (p * e2 - q * e1) / view.scale;
    view.centre_in_view = {a / view.scale, -b / view.scale, -centre_depth_};
    double squares = 0.0;
    for (const Sample& s : samples_) {
      const glm::dvec2 error = view.Project(s.p) - glm::dvec2(s.u, s.v);
      squares += 0.5 * glm::dot(error, error);
    }
    view.rms = std::sqrt(squares / static_cast<double>(samples_.size()));
    return view;
  }

  // Fits a camera with pixels of any shape, to explain why the right one fails with an error of `rms`. Empty where such
  // a camera fails too.
  std::string ShapeFault(bool orthographic, double rms) const {
    LeastSquares<4> along_u, along_v;
    const auto row = [&](const Sample& s) {
      const double k = orthographic ? 1.0 : centre_depth_ / s.z;
      const glm::dvec3 d = k * (s.p - centre_);
      return std::array<double, 4>{d.x, d.y, d.z, k};
    };
    for (const Sample& s : samples_) along_u.Add(row(s), s.u), along_v.Add(row(s), s.v);
    std::array<double, 4> u{}, v{};
    if (!along_u.Solve(u) || !along_v.Solve(v)) return "";
    double squares = 0.0;
    for (const Sample& s : samples_) {
      const auto r = row(s);
      double error_u = s.u, error_v = s.v;
      for (int i = 0; i < 4; ++i) error_u -= u[i] * r[i], error_v -= v[i] * r[i];
      squares += 0.5 * (error_u * error_u + error_v * error_v);
    }
    const double fitted_rms = std::sqrt(squares / static_cast<double>(samples_.size()));
    if (!(fitted_rms < kScatterRms && fitted_rms < 0.3 * rms)) return "";  // the shape explains little of the error
    glm::dvec3 gu(u[0], u[1], u[2]), gv(v[0], v[1], v[2]);
    gu -= glm::dot(gu, back_) * back_, gv -= glm::dot(gv, back_) * back_;
    const double length_u = glm::length(gu), length_v = glm::length(gv);
    if (!(length_u > 0.0 && length_v > 0.0)) return "";
    if (glm::dot(glm::cross(gu, -gv), back_) < 0.0) {
      return "the picture is mirrored; expected row 0 at the top and column 0 on the left";
    }
    const double skew = glm::dot(gu, gv) / (length_u * length_v);
    if (std::fabs(skew) > 1e-3) return "its pixels are skewed by " + Number(skew) + "; expected square ones";
    if (std::fabs(length_u / length_v - 1.0) > 1e-3) {
      return "its pixels are not square, " + Number(length_v / length_u, "%.4f") +
             " times as wide as high; set the render's pixel aspect to 1";
    }
    return "";
  }

  // Checks the view by reprojecting all covered pixels.
  Status Prove(const View& view, SolvedCamera& result) const {
    constexpr int kBlocks = 8;
    struct Block {
      glm::dvec2 sum{0.0};
      double count = 0.0;
    };
    std::vector<Block> blocks(kBlocks * kBlocks);
    std::size_t off = 0, far_off = 0;
    double squares = 0.0, typical_rounding = 0.0;
    for (const std::size_t i : covered_) {
      const Sample s = At(i);
      const glm::dvec2 error = view.Project(s.p) - glm::dvec2(s.u, s.v);
      const double rounding = position_rounding_ * (view.orthographic ? view.scale : view.scale / s.z);
      const double distance = glm::length(error);
      off += !(distance <= kExactPixels + rounding);
      far_off += !(distance <= kScatterPixels + rounding);
      squares += 0.5 * distance * distance;
      typical_rounding += rounding;
      const int column = static_cast<int>(i % in_.width), line = static_cast<int>(i / in_.width);
      Block& block = blocks[std::size_t(std::int64_t(line) * kBlocks / in_.height) * kBlocks +
                            std::size_t(std::int64_t(column) * kBlocks / in_.width)];
      block.sum += error, block.count += 1.0;
    }
    const double n = static_cast<double>(covered_.size());
    result.error_pixels = std::sqrt(squares / n);
    typical_rounding /= n;
    if (static_cast<double>(off) <= kOutliers * n) return Ok();
    bool scattered =
        static_cast<double>(far_off) <= kOutliers * n && result.error_pixels <= kScatterRms + typical_rounding;
    for (const Block& block : blocks) {
      if (block.count < 16.0) continue;
      const double limit = 6.0 * result.error_pixels / std::sqrt(block.count) + kExactPixels;
      scattered = scattered && glm::length(block.sum / block.count) <= limit;
    }
    if (scattered) {
      result.jittered = true;
      return Ok();
    }
    for (const bool orthographic : {false, true}) {
      const std::string fault = ShapeFault(orthographic, result.error_pixels);
      if (!fault.empty()) return Refusal(name_, fault);
    }
    return Refusal(name_, "the best one is off by " + Number(result.error_pixels) +
                              " px (root mean square), as with a panoramic or distorted lens, depth of field, a "
                              "moving camera's motion blur");
  }

  // OpenGL's matrices, as Blender's own calc_matrix_camera gives them.
  GuideCamera ToCamera(const View& view) const {
    double nearest = INFINITY, farthest = 0.0;
    for (const std::size_t i : covered_) {
      nearest = std::min(nearest, double(in_.depth[i])), farthest = std::max(farthest, double(in_.depth[i]));
    }
    const double near = std::max(0.5 * nearest, 1e-6 * farthest), far = 2.0 * farthest;
    GuideCamera camera;
    camera.name = "solved";
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(view.right, view.up, view.back));
    camera.view_from_world = glm::dmat4(rotation);
    camera.view_from_world[3] = glm::dvec4(view.centre_in_view - rotation * view.centre, 1.0);
    glm::dmat4& clip = camera.clip_from_view;
    clip = glm::dmat4(0.0);
    clip[0][0] = 2.0 * view.scale / in_.width;
    clip[1][1] = 2.0 * view.scale / in_.height;
    if (view.orthographic) {
      clip[2][2] = -2.0 / (far - near);
      clip[3] = glm::dvec4(0.0, 0.0, -(far + near) / (far - near), 1.0);
    } else {
      clip[2] = glm::dvec4(-2.0 * view.shift_u / in_.width, 2.0 * view.shift_v / in_.height,
                           -(far + near) / (far - near), -1.0);
      clip[3][2] = -2.0 * far * near / (far - near);
    }
    return camera;
  }

  const SolveCameraInput& in_;
  const std::string& name_;
  const std::string plane_mend_ = ", which any of several cameras would see alike";
  std::vector<std::size_t> covered_;
  std::vector<Sample> samples_;
  glm::dvec3 centre_{0.0}, back_{0.0};
  double centre_depth_ = 0.0;
  double position_rounding_ = 0.0;
};

}  // namespace

Expected<SolvedCamera> SolveCamera(const SolveCameraInput& input, const std::string& name) {
  return Solver(input, name).Run();
}

}  // namespace scumble
