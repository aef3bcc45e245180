#include "apps/studio/session/pick.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/guides.h"
#include "core/style/style_keys.h"
#include "transfer/source_field.h"
#include "transfer/style_map.h"

namespace scumble {
namespace {

// The field with the sizes of picture and field between which positions are converted: a picture that was scaled up has
// a smaller field.
struct FieldView {
  explicit FieldView(const PaintedFrame& frame)
      : painted(frame), field(*frame.field), factor(std::max(1, frame.picture.width / std::max(1, field.width))) {}

  bool Has(int x, int y) const { return x >= 0 && y >= 0 && x < field.width && y < field.height; }
  std::size_t At(int x, int y) const { return std::size_t(y) * field.width + x; }
  int StyleAt(std::size_t i) const { return painted.styles ? painted.styles->style[i] : 0; }
  bool IsPainted(std::size_t i) const {
    return field.level[i] >= 0 && std::size_t(StyleAt(i)) < painted.field_styles.size();
  }
  bool SharesChunk(std::size_t a, std::size_t b, int dx, int dy) const {
    return IsPainted(a) && IsPainted(b) && field.x[b] - field.x[a] == dx && field.y[b] - field.y[a] == dy &&
           field.exemplar[a] == field.exemplar[b] && StyleAt(a) == StyleAt(b);
  }
  const FieldStyle& FieldStyleAt(std::size_t i) const { return painted.field_styles[std::size_t(StyleAt(i))]; }
  const FieldExemplar& ExemplarAt(std::size_t i) const {
    const std::vector<FieldExemplar>& exemplars = FieldStyleAt(i).exemplars;
    return exemplars[std::min<std::size_t>(field.exemplar[i], exemplars.size() - 1)];
  }
  // In pixels of the exemplar's file.
  std::array<double, 2> SourceAt(std::size_t i) const {
    const FieldStyle& style = FieldStyleAt(i);
    const FieldExemplar& from = ExemplarAt(i);
    return {from.left + (field.x[i] + 0.5) * from.width / style.width,
            from.top + (field.y[i] + 0.5) * from.height / style.height};
  }

  const PaintedFrame& painted;
  const SourceField& field;
  int factor;
};

// Of the field's size: the chunk of one pixel, by flooding.
std::vector<char> ChunkOf(const FieldView& view, int x, int y) {
  std::vector<char> inside(std::size_t(view.field.width) * view.field.height, 0);
  if (!view.Has(x, y) || !view.IsPainted(view.At(x, y))) return inside;
  std::vector<std::array<int, 2>> open = {{x, y}};
  inside[view.At(x, y)] = 1;
  while (!open.empty()) {
    const auto [px, py] = open.back();
    open.pop_back();
    for (const auto& [dx, dy] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!view.Has(px + dx, py + dy)) continue;
      const std::size_t from = view.At(px, py), to = view.At(px + dx, py + dy);
      if (inside[to] || !view.SharesChunk(from, to, dx, dy)) continue;
      inside[to] = 1;
      open.push_back({px + dx, py + dy});
    }
  }
  return inside;
}

Picture MaskPicture(const FieldView& view, const std::vector<char>& inside) {
  Picture mask(view.field.width * view.factor, view.field.height * view.factor);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (inside[view.At(x / view.factor, y / view.factor)]) std::fill_n(mask.At(x, y), 4, std::uint16_t(0xffff));
    }
  }
  return mask;
}

std::string NameOf(const std::map<std::uint32_t, std::string>& names, const GuideSet& guides, Layer layer,
                   std::size_t i) {
  if (!guides.Has(layer)) return "";
  const auto found = names.find(IdOf(guides.Plane(layer)[i]));
  return found == names.end() ? "" : found->second;
}

nlohmann::json ChunkJson(const FieldView& view, int x, int y) {
  const std::vector<char> inside = ChunkOf(view, x, y);
  std::size_t area = 0;
  std::array<int, 4> box = {view.field.width, view.field.height, 0, 0};
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (!inside[i]) continue;
    const int px = int(i % view.field.width), py = int(i / view.field.width);
    box = {std::min(box[0], px), std::min(box[1], py), std::max(box[2], px + 1), std::max(box[3], py + 1)};
    ++area;
  }
  for (int& edge : box) edge *= view.factor;
  return {{"area", area * view.factor * view.factor}, {"box", box}};
}

}  // namespace

nlohmann::json PickAt(const PaintedFrame& frame, int x, int y) {
  const FieldView view(frame);
  const int fx = x / view.factor, fy = y / view.factor;
  nlohmann::json pick = {{"covered", false}};
  if (x < 0 || y < 0 || !view.Has(fx, fy)) return pick;
  const GuideSet& guides = *frame.guides;  // of the field's size, or smaller where the transfer upsamples
  const int upsampling = std::max(1, view.field.width / std::max(1, guides.width()));
  const std::size_t g = std::size_t(fy / upsampling) * guides.width() + std::size_t(fx / upsampling);
  pick["object"] = NameOf(guides.object_names, guides, Layer::kObject, g);
  pick["material"] = NameOf(guides.material_names, guides, Layer::kMaterial, g);
  if (guides.Has(Layer::kNormal)) {
    for (int c = 0; c < 3; ++c) pick["normal"].push_back(guides.Plane(Layer::kNormal, c)[g]);
  }
  pick["luminance"] = nullptr;
  if (guides.Has(Layer::kLuminance)) pick["luminance"] = guides.Plane(Layer::kLuminance)[g];
  const std::size_t i = view.At(fx, fy);
  if (!view.IsPainted(i)) return pick;
  pick["covered"] = true;
  pick["style"] = view.StyleAt(i);
  if (IsUnpainted(view.ExemplarAt(i).file)) return pick;  // it is made up
  pick["exemplar"] = int(view.field.exemplar[i]);
  pick["source"] = view.SourceAt(i);
  pick["level"] = int(view.field.level[i]);
  pick["chunk"] = ChunkJson(view, fx, fy);
  return pick;
}

Picture ChunkMask(const PaintedFrame& frame, int x, int y) {
  const FieldView view(frame);
  const auto place = [&](int at) { return at < 0 ? -1 : at / view.factor; };
  return MaskPicture(view, ChunkOf(view, place(x), place(y)));
}

Picture FedMask(const PaintedFrame& frame, int style, int exemplar, double x, double y, double radius) {
  const FieldView view(frame);
  std::vector<char> inside(std::size_t(view.field.width) * view.field.height, 0);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (!view.IsPainted(i) || view.StyleAt(i) != style || view.field.exemplar[i] != exemplar) continue;
    const auto [sx, sy] = view.SourceAt(i);
    inside[i] = std::hypot(sx - x, sy - y) <= radius;
  }
  return MaskPicture(view, inside);
}

}  // namespace scumble
