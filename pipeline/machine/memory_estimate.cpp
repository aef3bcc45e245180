#include "pipeline/memory_estimate.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>
#include <vector>

#include "core/image/fragments.h"
#include "core/io/picture_file.h"
#include "core/style/sphere_template.h"
#include "finish/finish.h"
#include "guidegen/path_layers.h"
#include "transfer/prepared_exemplar.h"

namespace scumble {
namespace {

using Bytes = std::uint64_t;

constexpr Bytes kMega = 1'000'000;
constexpr Bytes kFloat = 4;
constexpr Bytes kPaint = 8;  // of a pixel of a Picture

constexpr Bytes kProgram = 30 * kMega, kThread = 4 * kMega;
constexpr Bytes kFormatsModule = 125 * kMega;  // OpenImageIO and what it loads
constexpr Bytes kDecoded = 16;                 // of a pixel of a JPEG or WebP, beside the picture that comes of it
constexpr Bytes kTriangle = 340;  // or a segment of hair: ours, Embree's, and what reading a text of it leaves behind
constexpr Bytes kVertex = 40;     // what triangles that share no corners have more, while normals are made
constexpr Bytes kPlacedTriangle = 220;  // Embree's, of each further instance: corners, hierarchy, that of what shines
constexpr Bytes kInstance = 2300;       // its node in the file, ours, and Embree's geometry

// Of transfer/: what one pixel takes.
constexpr Bytes kSource = 7;            // SourceField and who is painted
constexpr Bytes kGuideOffset = 13;      // SourceField::guide_offset and who is matched, where not every pixel is
constexpr Bytes kMatched = 32;          // of one that is matched then
constexpr Bytes kSlopes = 8;            // DepthSlopes
constexpr Bytes kSurfaceSeeds = 48;     // MatchCoherent
constexpr Bytes kBandTile = 110'000;    // seeds of 512 columns, for one thread
constexpr int kBandRadius = 3;          // up to it sources are kept for a few rows only
constexpr Bytes kExplained = 24;        // planes that --show is drawn from, and a second picture
constexpr Bytes kFoundSphere = 8;       // FindSphere, beside the picture
constexpr Bytes kTones = 8 * kMega;     // SourceVariation, of an exemplar of any size
constexpr Bytes kPixelsOfFragment = 8;  // with --aa: objects' borders are rarely denser
constexpr Bytes kPlacedFragment = 12;   // UpsampleGuides
constexpr Bytes kPixelsOfStroke = 8;    // of painted edges: outlines are rarely denser
constexpr Bytes kCoherence = 9;         // MeasureCoherence, for --json

Bytes PixelsOf(const Size& size) { return Bytes(size.width) * Bytes(size.height); }

Bytes ChannelsOf(const LayerSet& layers) {
  Bytes channels = 0;
  for (const LayerInfo& info : AllLayers()) channels += layers.Has(info.layer) ? Bytes(ChannelCount(info.layer)) : 0;
  return channels;
}

LayerSet Made(LayerSet layers) { return layers.Add(AlwaysWritten()); }

Bytes ThreadsOf(int threads) {
  return threads > 0 ? Bytes(threads) : std::max<Bytes>(1, std::thread::hardware_concurrency());
}

// Planes, or a file of them in memory: nothing promises that pixels pack, and halves are made before they are packed.
Bytes PlanesOf(const Size& size, const LayerSet& layers) { return kFloat * ChannelsOf(layers) * PixelsOf(size); }

bool NeedsModule(const std::string& output) {
  const std::size_t dot = output.rfind('.');
  std::string ending = dot == std::string::npos ? "" : output.substr(dot);
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return !ending.empty() && ending != ".png" && ending != ".exr" && ending != ".tif" &&
         ending != ".tiff";  // a plan has no output
}

// Of a pixel of the picture, to encode it; without the file's module.
Bytes EncodedBytes(const PictureRequest& options) {
  if (HasEnding(options.output, {".exr"}))
    return 8 * kFloat;  // four floats, and as many in the file; or halves and halves
  const Bytes samples = options.bits == 16 ? 8 : 4;
  // PNG is packed by bands, which are joined; others are turned into the file's own bits, and a file that grows is
  // copied.
  return samples * (NeedsModule(options.output) ? 3 : 2);
}

// OpenImageIO stays once a file has been read by it.
void TakeReader(MemoryNeed& need) {
  if (!need.Holds("reader")) need.Take("reader", kFormatsModule);
}

// Whether the transfer keeps the sources of the whole picture.
bool KeepsSources(const Style& style, int radius) {
  const TransferSettings& settings = style.transfer;
  return settings.method != Method::kStyleBlit || settings.coherent || settings.match_step > 1 ||
         !settings.guide_weights.ArePlain() || settings.edge == EdgeMode::kExemplar || radius > kBandRadius;
}

int RadiusOf(const Style& style, int height) {
  const int reference = style.transfer.reference_height;
  const double ratio = reference > 0 ? static_cast<double>(height) / reference : 1.0;
  return static_cast<int>(std::min(1024.0, std::floor(style.transfer.blend_radius * ratio + 0.5)));
}

// A style's pictures as they were read, and what Prepare makes of them for an output of that height.
void AddStyle(const Style& style, int height, MemoryNeed& need) {
  const TransferSettings& settings = style.transfer;
  const auto scaled = [&](int side) {
    return Bytes(ScaledSize(side, settings.scale, settings.reference_height, height));
  };
  Bytes read = 0, prepared = 0, largest = 0, whole = 0;
  for (const Exemplar& exemplar : style.exemplars) {
    const Bytes file = Bytes(exemplar.picture.width) * Bytes(exemplar.picture.height);
    const Bytes width = scaled(style.exemplars.front().picture.width);
    const Bytes texels = width * scaled(style.exemplars.front().picture.height);
    read += kPaint * file;
    if (style.unpainted.empty() && NeedsOpenImageIo(exemplar.name)) TakeReader(need);
    if (exemplar.cut) {
      const Bytes pixels = Bytes(exemplar.cut->file_width) * Bytes(exemplar.cut->file_height);
      whole = std::max(whole, (kPaint + kFoundSphere) * pixels);
    }
    if (exemplar.guides) read += kFloat * ChannelsOf(exemplar.guides->layers()) * exemplar.guides->pixel_count();
    Bytes of_texel = kPaint;
    if (!exemplar.is_sphere) of_texel += 13;  // normals and what is usable
    if (!settings.guide_weights.ArePlain()) of_texel += 3 * kFloat * ChannelsOf(settings.guide_weights.Layers());
    if (settings.hybrid > 0.0) of_texel += kPaint;                      // the tone
    if (settings.variety > 0.0 && !exemplar.is_sphere) of_texel += 12;  // an index of normals
    if (settings.variety > 0.0) prepared += kTones;
    if (settings.shadow == ShadowMode::kPaint) of_texel += 24;
    if (settings.nearest == NearestSearch::kTree) of_texel += 32;
    if (settings.edge == EdgeMode::kExemplar) of_texel += kPaint;  // the paint near the rim
    prepared += of_texel * texels;
    // Copies while one is extended, resized along x, turned and resized along y; or of the points of a search, or of
    // the planes of a blur.
    const Bytes between = width * Bytes(exemplar.picture.height);
    largest = std::max(largest, kPaint * (file + 2 * between + texels) + (exemplar.is_sphere ? 0 : 40 * texels) +
                                    (settings.hybrid > 0.0 ? 32 * texels : 0));
  }
  if (style.paper.picture) {
    const Picture& paper = *style.paper.picture;
    read += kPaint * Bytes(paper.width) * Bytes(paper.height);
    const auto fit = [&](int side) { return Bytes(ScaledSize(side, 1.0, settings.reference_height, height)); };
    prepared += kPaint * fit(paper.width) * fit(paper.height);
    // Turned, resized along x, and turned back.
    const Bytes file = Bytes(paper.width) * Bytes(paper.height);
    largest = std::max(largest, kPaint * (file + 2 * fit(paper.width) * Bytes(paper.height)));
    AddPictureRead(style.paper.file, file, need);
  }
  need.TakeTransient("finding a sphere", whole);
  need.Take("styles", read);
  need.Take("exemplars", prepared);
  need.TakeTransient("preparing exemplars", largest);
}

// The sources of all pixels and what their match and votes look at.
void AddSources(const PictureWork& work, const Size& size, MemoryNeed& need) {
  const Bytes pixels = PixelsOf(size);
  bool keeps = work.keeps_field, lit = false, hybrid = false;
  Bytes of_pixel = 0, transient = 0;
  int step = 1;
  for (const Style& style : work.styles) {
    keeps = keeps || KeepsSources(style, RadiusOf(style, size.height));
    lit = lit || LooksAtLight(style);
    hybrid = hybrid || style.transfer.hybrid > 0.0;
    step = std::max(step, style.transfer.match_step);
    if (style.transfer.coherent) transient = std::max(transient, kSurfaceSeeds);
  }
  if (step > 1) of_pixel += kGuideOffset, transient = std::max(transient, kMatched / Bytes(step * step) + 1);
  if (keeps) of_pixel += kSource, transient += kSlopes;
  if (lit) transient += kFloat;  // exposed
  if (work.has_map) of_pixel += 2;
  if (of_pixel > 0) need.Take("sources", of_pixel * pixels);
  if (hybrid) need.Take("votes on base layers", kPaint * pixels);
  const Bytes tiles = (Bytes(size.width) + 511) / 512;
  need.Take("seeds of the threads", ThreadsOf(work.threads) * tiles * kBandTile * work.styles.size());
  if (transient > 0) need.TakeTransient("match and votes", transient * pixels);
}

}  // namespace

void AddPictureRead(const std::filesystem::path& file, std::uint64_t pixels, MemoryNeed& need) {
  if (NeedsOpenImageIo(file)) TakeReader(need);
  need.TakeTransient("reading a picture", kDecoded * pixels);
}

void AddProgram(int threads, MemoryNeed& need) { need.Take("program", kProgram + kThread * ThreadsOf(threads)); }

void AddScene(const Scene& scene, const TexturePixels& more, MemoryNeed& need) {
  Bytes bytes = kPaint * more.all;
  const auto primitives = [](const Mesh& mesh) { return mesh.triangles.size() + mesh.curves.segments.size(); };
  for (const Mesh& mesh : scene.meshes) bytes += kTriangle * primitives(mesh) + kVertex * mesh.positions.size();
  // Embree is given each instance's triangles where they stand. Those that an exact copy covers it is not, but they are
  // rare, and finding them takes a look at every corner.
  std::vector<bool> placed(scene.meshes.size());
  for (const Instance& instance : scene.instances) {
    const auto mesh = std::size_t(instance.mesh);
    if (placed[mesh]) bytes += kPlacedTriangle * primitives(scene.meshes[mesh]);
    placed[mesh] = true;
    bytes += kInstance;
  }
  for (const Picture& texture : scene.textures) bytes += kPaint * Bytes(texture.width) * Bytes(texture.height);
  for (const auto& texture : scene.encoded_textures) bytes += texture ? Bytes(texture->bytes) : 0;
  if (more.largest > 0) TakeReader(need);
  need.Take("scene", bytes);
  need.TakeTransient("decoding a texture", kDecoded * more.largest);
}

void AddGuides(const Size& size, const LayerSet& layers, const SceneRequest& options, MemoryNeed& need) {
  const Bytes pixels = PixelsOf(size);
  need.Take("guides", PlanesOf(size, Made(layers)));
  if (layers.Has(Layer::kOutline)) need.TakeTransient("distances to outlines", 3 * kFloat * PixelsOf(size));
  if (options.aa > 1) {
    // As found by the threads and as gathered, both in vectors that may have grown to twice their content, and colours.
    const Bytes of_fragment = 2 * kFloat * (ChannelsOf(Made(layers)) + 5) + 4 * kPaint;
    need.Take("fragments", of_fragment * FragmentsExpected(size, options.aa));
  }
  Bytes path_layers = 0;
  for (const LayerInfo& info : AllLayers()) path_layers += layers.Has(info.layer) && PathLayerExpression(info.layer);
  if (path_layers == 0) return;
  // Lists of pixels that grow: twice what they hold, and the copy that they grew from.
  constexpr Bytes kPathPixel = 40, kSum = 24;
  const bool open_ended = options.noise > 0.0 || options.time_budget_seconds > 0.0;
  need.TakeTransient("light paths", (2 * kPathPixel + (open_ended ? kSum * path_layers : 0)) * pixels);
}

std::size_t FragmentsExpected(const Size& size, int aa) { return aa > 1 ? PixelsOf(size) / kPixelsOfFragment : 0; }

void AddGuideFile(const Size& size, const LayerSet& layers, bool cryptomatte, MemoryNeed& need) {
  // The mattes of objects and materials; in the file their channels, and the ids once more.
  constexpr Bytes kMattePlanes = 8 + 10;
  need.TakeTransient("guide file",
                     PlanesOf(size, Made(layers)) + (cryptomatte ? kMattePlanes * kFloat * PixelsOf(size) : 0));
}

void AddGuidesBehind(const Size& size, const LayerSet& layers, MemoryNeed& need) {
  need.Take("frame that is written", 2 * PlanesOf(size, Made(layers)));
}

void AddGuidesRead(const GuideFileInfo& info, const GuideReadOptions& read, MemoryNeed& need) {
  const Bytes pixels = Bytes(info.width) * Bytes(info.height);
  LayerSet layers = read.required;
  layers.Add(read.optional);
  if (info.fragments > 0) {
    layers.Add({Layer::kObject, Layer::kMaterial});
    // As they stand in the file's header, in a copy of it and in memory, with an index each, and their colours.
    const Bytes of_fragment = 3 * kFloat * (ChannelsOf(info.layers.begin()->second) + 2) + 4 * kPaint;
    need.Take("fragments", of_fragment * info.fragments);
  }
  need.Take("guides", kFloat * ChannelsOf(layers) * pixels);
  const bool from_matte = info.has_cryptomatte && !info.header.attributes.count("scumble:generator");
  const bool plain = !info.from_blender && !from_matte && info.layers.size() == 1 && info.layers.begin()->first.empty();
  if (plain) return;
  // Another reader: all channels side by side, then by layer.
  Bytes channels = 1;
  for (const auto& [name, found] : info.layers) channels += ChannelsOf(found);
  channels = std::max<Bytes>(channels, 1 + Bytes(std::count(info.channels.begin(), info.channels.end(), ',')));
  TakeReader(need);
  need.TakeTransient("channels of the file", kFloat * channels * pixels);
}

void AddPicture(const PictureWork& work, const PictureRequest& options, MemoryNeed& need) {
  const int factor = options.GuideFactor();
  const Size size{work.guides.width * factor, work.guides.height * factor};  // as it is painted
  const Bytes pixels = PixelsOf(size), encoded = EncodedBytes(options);
  const Bytes larger = Bytes(options.PictureFactor()) * Bytes(options.PictureFactor());
  if (work.is_sequence) need.Take("frame that is written", (kPaint + encoded) * pixels * larger);
  if (factor > 1) {
    const Bytes of_pixel = kFloat * ChannelsOf(Made(work.layers));
    // A list of them that may have grown to twice its content, their index and colour.
    const Bytes of_fragment = of_pixel + 2 * kPlacedFragment + kFloat + kPaint;
    const Bytes fragments = Bytes(work.fragments) * Bytes(factor) * Bytes(factor);
    need.Take("upsampled guides", of_pixel * pixels + of_fragment * fragments);
  }
  if (!options.over.empty()) {
    need.Take("picture underneath", kPaint * pixels);
    AddPictureRead(options.over, pixels, need);
  }
  for (const Style& style : work.styles) AddStyle(style, size.height, need);
  need.Take("picture", kPaint * pixels);
  AddSources(work, size, need);
  FinishChain chain;
  for (const Style& style : work.styles) Append(FinishOf(style), chain);
  if (work.finish) Append(*work.finish, chain);
  AddFinish(chain, work.has_map, size, need);
  const bool has_strokes = std::any_of(work.styles.begin(), work.styles.end(),
                                       [](const Style& style) { return style.transfer.edge == EdgeMode::kExemplar; });
  // One list, made of those of the rows, which may have grown to twice their content.
  if (has_strokes && !chain.passes.empty())
    need.Take("strokes of edges", 3 * sizeof(EdgeStroke) * pixels / kPixelsOfStroke);
  if (std::any_of(chain.passes.begin(), chain.passes.end(),
                  [](const FinishPass& pass) { return pass.at == FinishPass::Stage::kGuides; })) {
    need.Take("changed guides", (kFloat * ChannelsOf(Made(work.layers)) + kPaint) * pixels);
  }
  if (!options.layers_out.empty() || !options.show_finish.empty())
    AddFinishLayers(chain.passes.size(), !options.layers_out.empty(), work.is_sequence, size, need);
  if (options.show)
    need.TakeTransient("explaining", kExplained * pixels);
  else if (work.keeps_field)
    need.TakeTransient("figures", kCoherence * pixels);
  if (NeedsModule(options.output) && !need.Holds("reader")) need.Take("writer", kFormatsModule);
  // Scaled up along x, then along y.
  if (larger > 1) need.Take("scaled picture", kPaint * pixels * larger);
  if (larger > 1) need.TakeTransient("scaling it", kPaint * pixels * Bytes(options.PictureFactor()));
  need.TakeTransient("picture file", encoded * pixels * larger);
}

namespace {

constexpr Bytes kLab = 3 * kFloat;

// Bytes of a pixel: the colours before, and with keys between objects, and what the filter needs besides.
Bytes OfSmooth(const SmoothPass& pass) {
  constexpr Bytes kPlanes = 2 * kLab + kFloat;
  switch (pass.filter) {
    case SmoothPass::Filter::kBilateral:
      return kPlanes + kLab;
    case SmoothPass::Filter::kKuwahara:
      return kPlanes + 3 * kLab;  // the tensor, plain and blurred, and the directions
    case SmoothPass::Filter::kGuided:
      return kPlanes + 4 * 2 + 9 * kFloat;  // windows, two sets of four channels
    case SmoothPass::Filter::kWavelets:
      return kPlanes + kLab + 4 * kFloat;  // normals and depth
  }
  return 0;
}

// Bytes of a pixel: the tone of light, and while it is evened out what it lies on, its keys, two lights and the result.
constexpr Bytes kToneOfLight = 6 * kFloat;

Bytes OfHatch(const HatchPass& pass) {
  const bool of_light = pass.tone == HatchPass::Tone::kLight;
  const bool has_second = !of_light && pass.along == HatchPass::Along::kLight;
  const Bytes planes = kFloat + (pass.stick ? kFloat : 0);  // the tone, and the surfaces' scale
  // A number of each pixel's patch, and whether it is flat; on surfaces a key besides.
  const Bytes patches = kFloat + 1 + (pass.stick ? 8 : 0) + (has_second ? kFloat : 0);
  const Bytes evening = of_light ? kToneOfLight : has_second ? planes + kToneOfLight : 0;
  return std::max(planes + patches, evening);
}

// As kToneOfLight, but what light lies on is the guides'.
Bytes OfToon(const ToonPass& pass) {
  if (pass.bands == 1 && pass.shading == ToonPass::Shading::kPlain) return 0;
  const bool is_sampled = pass.light == ToonPass::Light::kLuminance || pass.cast > 0.0;
  return pass.bands > 1 && is_sampled ? 5 * kFloat : Bytes(kFloat);
}

// Bytes of a pixel, or of a file.
struct FinishBytes {
  Bytes masks = 0;      // the pixels that it is for
  Bytes picture = 0;    // of a mask, of the file
  Bytes ramp = 0;       // of colours
  Bytes transient = 0;  // its work
  Bytes mixes = 0;      // copies for a mask
};

FinishBytes OfPass(const FinishPass& pass, bool has_map) {
  // Borders by pixel, the share that strokes cover, and lines: a tenth of the pixels have a border, and each is a point
  // of 40 bytes and a piece of a stroke of 28, in lists that grow.
  constexpr Bytes kOutline = 2 + kFloat + (40 + 2 * 28 + 24) / 10;
  FinishBytes bytes;
  if (!(pass.strength > 0.0)) return bytes;
  Bytes& transient = bytes.transient;
  const bool has_names = !pass.objects.empty() || !pass.materials.empty();
  bytes.masks = (has_map ? 1 : 0) + (has_names ? 2 : 0) + (pass.mask.empty() ? 0 : 2);
  if (pass.mask.picture) bytes.picture = kPaint * pass.mask.picture->rgba.size() / 4;
  if (!pass.mask.empty()) bytes.mixes = pass.mask.picture ? 2 * kPaint : Bytes(kPaint);
  if (const auto* smooth = std::get_if<SmoothPass>(&pass.effect)) transient = OfSmooth(*smooth);
  if (const auto* hatch = std::get_if<HatchPass>(&pass.effect)) transient = OfHatch(*hatch);
  // The tone and the response; with flow the tone and the tensor, plain and blurred, and the directions.
  if (const auto* edges = std::get_if<EdgesPass>(&pass.effect))
    transient = edges->flow > 0.0 ? kFloat + 3 * kLab : (edges->borders ? 6 : 2) * kFloat;
  const auto* shadows = std::get_if<ShadowsPass>(&pass.effect);
  if (shadows && shadows->soften > 0.0) transient = 6 * kFloat;  // the shade, its sums and weights
  // Two copies, sigmas, shares, and a level of the picture's size.
  const auto* depth = std::get_if<DepthPass>(&pass.effect);
  if (depth && depth->blur > 0.0) transient = 2 * kLab + 2 * kFloat + 5 * kFloat;
  // Distances and rims, the lattice and the waves of four noises, a copy.
  const auto* pigment = std::get_if<PigmentPass>(&pass.effect);
  if (pigment) transient = 2 + kFloat + 8 + (pigment->stick ? 3 : 1) * kFloat + kPaint;
  const auto* toon = std::get_if<ToonPass>(&pass.effect);
  if (toon) transient = OfToon(*toon);
  const auto* tones = std::get_if<TonesPass>(&pass.effect);
  if (tones && tones->tone == TonesPass::Tone::kLight) transient = kToneOfLight;
  if (toon && toon->ramp_colors) bytes.ramp = (sizeof(Rgb16) + kLab) * toon->ramp_colors->colors.size();
  const auto* outline = std::get_if<OutlinePass>(&pass.effect);
  if (!outline) return bytes;
  transient = kOutline;
  if (outline->of_class[std::size_t(LineClass::kSuggestive)] > 0.0) transient += 4 * kFloat + 1;
  if (outline->color != OutlinePass::Color::kInk || !pass.mask.empty()) transient += 4 + kPaint;
  if (outline->of_class[std::size_t(LineClass::kTexture)] > 0.0) transient += 3 * kFloat;
  const bool is_noisy = outline->wobble > 0.0 || outline->gaps > 0.0;
  if (outline->form == OutlinePass::Form::kField) transient = std::max<Bytes>(transient, 2 + 2 + 2 * kFloat);
  if (outline->stick && is_noisy) transient = std::max(transient, kOutline + 2 * kFloat);
  return bytes;
}

}  // namespace

void AddFinish(const FinishChain& chain, bool has_map, const Size& size, MemoryNeed& need) {
  Bytes masks = 0, transient = 0, mixes = 0;
  bool measures = false;
  for (std::size_t i = 0; i < chain.passes.size(); ++i) {
    const std::vector<FinishPass> moments = MomentsOf(chain, i);
    FinishBytes most;
    for (const FinishPass& moment : moments) {
      const FinishBytes one = OfPass(moment, has_map);
      most.masks = std::max(most.masks, one.masks), most.picture = std::max(most.picture, one.picture);
      most.ramp = std::max(most.ramp, one.ramp);
      transient = std::max(transient, one.transient), mixes = std::max(mixes, one.mixes);
    }
    masks += most.masks;
    if (most.picture > 0) need.Take("mask", most.picture);
    if (most.ramp > 0) need.Take("ramp", most.ramp);
    measures = measures || LooksAtMeasures(moments);
  }
  if (masks > 0) need.Take("finish", masks * PixelsOf(size));
  transient += mixes;
  if (measures) transient = std::max(transient, Bytes(2 * kFloat));  // a copy of a plane that grows
  if (transient > 0) need.TakeTransient("finishing", transient * PixelsOf(size));
}

void AddFinishLayers(std::size_t passes, bool all, bool is_sequence, const Size& size, MemoryNeed& need) {
  const Bytes pixels = PixelsOf(size);
  // While passes work: a copy of the picture, the picture before a pass, both over the ground, the layers below, the
  // pass's own, and how dense its ink is.
  need.Take("making layers", (6 * kPaint + 2) * pixels);
  if (!all) return;
  // Ground and paint, too; a frame may be written while the next is made. Files are there once by layer, in the archive
  // and as it is written, and with the merged picture.
  const Bytes layers = Bytes(passes) + 2;
  need.Take("layers", (is_sequence ? 2 : 1) * (layers + 1) * kPaint * pixels);
  need.TakeTransient("file of layers", 2 * (layers + 1) * 4 * pixels + pixels / 64);
}

void AddKit(int size, std::size_t lights, const LayerSet& layers, bool has_layers_file, MemoryNeed& need) {
  const Size square{size, size};
  const Bytes side = Bytes(size) + 2 * Bytes(TemplateMargin(size)), pixels = side * side;
  // Template files are kept until all are made: one picture, ten in a file of layers, a page.
  const Bytes files = 4 * (has_layers_file ? 3 : 1);
  need.Take("guides", lights * PlanesOf(square, Made(layers)));
  if (layers.Has(Layer::kLpeLSE)) need.TakeTransient("highlight", PlanesOf(square, Made({Layer::kLpeLSE})));
  need.Take("templates", lights * files * pixels);
  need.TakeTransient("drawing", (3 * kPaint + 8) * pixels);
  need.TakeTransient("guide file", PlanesOf(square, Made(layers)));
}

}  // namespace scumble
