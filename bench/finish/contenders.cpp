#include "bench/finish/contenders.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

#ifdef SCUMBLE_BENCH_OPENCV
#include <opencv2/imgproc.hpp>
#ifdef SCUMBLE_BENCH_XIMGPROC
#include <opencv2/ximgproc.hpp>
#endif
#endif

namespace scumble::bench {

#ifdef SCUMBLE_BENCH_OPENCV
namespace {

// The guided filter of finish/smooth/smooth_guided.cpp without borders, put together from box filters.
void GuidedByBoxes(const cv::Mat& picture, int side, float flat, cv::Mat& out) {
  const auto box = [&](const cv::Mat& from) {
    cv::Mat to;
    cv::boxFilter(from, to, CV_32F, {side, side});
    return to;
  };
  cv::Mat planes[3];
  cv::split(picture, planes);
  cv::Mat variance = cv::Mat::zeros(picture.size(), CV_32F), means[3];
  for (int c = 0; c < 3; ++c) {
    means[c] = box(planes[c]);
    variance += planes[c].mul(planes[c]);
  }
  variance = box(variance);
  for (const cv::Mat& mean : means) variance -= mean.mul(mean);
  const cv::Mat gain = variance / (variance + flat), mean_gain = box(gain);
  for (int c = 0; c < 3; ++c) planes[c] = planes[c].mul(mean_gain) + box(means[c].mul(1.0f - gain));
  cv::merge(planes, 3, out);
}

}  // namespace

std::vector<Contender> OpenCvContenders(int width, int height, const std::vector<float>& rgb) {
  const cv::Mat picture = cv::Mat(height, width, CV_32FC3, const_cast<float*>(rgb.data())).clone();
  cv::Mat plane;
  cv::extractChannel(picture, plane, 0);
  const auto out = std::make_shared<cv::Mat>();
  using Filter = Contender::Filter;
  std::vector<Contender> contenders = {
      {Filter::kBilateral, "cv::bilateralFilter, d 13", [=] { cv::bilateralFilter(picture, *out, 13, 0.08, 3.0); }},
      {Filter::kGuidedByBoxes, "guided, of cv::boxFilter", [=] { GuidedByBoxes(picture, 9, 0.0016f, *out); }},
      {Filter::kGaussians, "cv::GaussianBlur, two", [=] {
         cv::GaussianBlur(plane, *out, {}, 2.0 / 2.055);
         cv::GaussianBlur(plane, *out, {}, 3.2 / 2.055);
       }}};
#ifdef SCUMBLE_BENCH_XIMGPROC
  contenders.push_back({Filter::kGuided, "cv::ximgproc::guidedFilter",
                        [=] { cv::ximgproc::guidedFilter(picture, picture, *out, 4, 0.0016); }});
#endif
  return contenders;
}
#else
std::vector<Contender> OpenCvContenders(int, int, const std::vector<float>&) { return {}; }
#endif

Contender PlainKuwahara(int width, int height, const std::vector<float>& rgb, int every) {
  return {Contender::Filter::kKuwahara, "kuwahara, radius 6, plain loop", [=] {
            constexpr int kRadius = 6, kSectors = 8;
            constexpr float kZeta = 1.0f / 3.0f, kEta = 3.774f;
            std::vector<float> out(rgb.size());
            tbb::parallel_for(tbb::blocked_range<int>(0, (height + every - 1) / every, 4), [&](const auto& rows) {
              for (int y = every * rows.begin(); y < std::min(height, every * rows.end()); y += every) {
                for (int x = 0; x < width; ++x) {
                  float sums[kSectors][5] = {};
                  for (int v = -kRadius; v <= kRadius; ++v) {
                    for (int u = -kRadius; u <= kRadius; ++u) {
                      if (u * u + v * v > kRadius * kRadius) continue;
                      const float right = float(u) / kRadius, down = float(v) / kRadius;
                      float weight[kSectors], sum = 0.0f;
                      for (int k = 0; k < kSectors; ++k) {
                        static const float kCos[] = {1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f, 0, 0.70710678f};
                        const float along = kCos[k] * right + kCos[(k + 6) % 8] * down,
                                    beside = kCos[k] * down - kCos[(k + 6) % 8] * right;
                        const float part = std::max(0.0f, along + kZeta - kEta * beside * beside);
                        weight[k] = part * part, sum += weight[k];
                      }
                      const float fall = std::exp(-3.125f * (right * right + down * down)) / sum;
                      const std::size_t q = 3 * (std::size_t(std::clamp(y + v, 0, height - 1)) * std::size_t(width) +
                                                 std::size_t(std::clamp(x + u, 0, width - 1)));
                      const float *const c = rgb.data() + q, square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
                      for (int k = 0; k < kSectors; ++k) {
                        const float w = weight[k] * fall;
                        sums[k][0] += w * c[0], sums[k][1] += w * c[1], sums[k][2] += w * c[2];
                        sums[k][3] += w * square, sums[k][4] += w;
                      }
                    }
                  }
                  float mean[4] = {};
                  for (const auto& one : sums) {
                    const float r = one[0] / one[4], g = one[1] / one[4], b = one[2] / one[4];
                    const float variance = std::max(0.0f, one[3] / one[4] - (r * r + g * g + b * b)) * 65025.0f;
                    const float w = 1.0f / (1.0f + variance * variance * variance);
                    mean[0] += w * r, mean[1] += w * g, mean[2] += w * b, mean[3] += w;
                  }
                  for (std::size_t c = 0; c < 3; ++c)
                    out[3 * (std::size_t(y) * std::size_t(width) + std::size_t(x)) + c] = mean[c] / mean[3];
                }
              }
            });
          }};
}

}  // namespace scumble::bench
