#include "bench/or_stop.h"
#include "bench/performance/performance.h"

namespace scumble::bench {

Engine::Engine(const Style& style, int height, int threads) : Engine(std::vector<Style>{style}, height, {}, threads) {}

Engine::Engine(const std::vector<Style>& styles, int height, std::vector<StyleMap> maps, int threads)
    : maps_(std::move(maps)) {
  for (const Style& style : styles) styles_.push_back(OrStop(Prepare(style, height)));
  options.threads = threads;
}

void Engine::Paint(const Frame& frame, bool mirrored) {
  ++options.frame;
  const GuideSet& guides = mirrored ? frame.mirrored : frame.guides;
  if (maps_.empty()) {
    OrStop(Transfer(styles_.front(), guides, options, scratch_, picture_));
    return;
  }
  std::vector<const PreparedStyle*> styles;
  for (const PreparedStyle& style : styles_) styles.push_back(&style);
  OrStop(Transfer(styles, maps_[mirrored ? 1 : 0], guides, options, scratch_, picture_));
}

std::function<void()> Painting(Engine& engine, const Frame& frame) {
  return [&engine, &frame, turn = 0]() mutable {
    engine.Paint(frame, turn % 2 == 1);
    if (frame.mirrored.width() > 0) ++turn;
  };
}

}  // namespace scumble::bench
