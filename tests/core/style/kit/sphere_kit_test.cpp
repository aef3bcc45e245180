// The artist's kit, from the template to the style that loads.
#include "core/style/sphere_kit.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/file/zip_archive.h"
#include "core/io/guide_file.h"
#include "core/io/open_raster.h"
#include "core/io/picture_file.h"
#include "core/style/fiducials.h"
#include "core/style/kit/template_pdf.h"
#include "core/style/style_file.h"
#include "tests/support/refusal.h"
#include "tests/support/sphere_guides.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

Picture RandomPicture(int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(width, i) % 256 * 257);
  }
  return picture;
}

Picture InnerSquare(const Picture& picture, int margin) {
  const int size = picture.width - 2 * margin;
  Picture inner(size, size);
  for (int y = 0; y < size; ++y) std::copy_n(picture.At(margin, margin + y), 4 * size, inner.At(0, y));
  return inner;
}

// While another run writes to the folder, here one that has it locked, the kit waits, and then adds to what is there.
TEST(SphereKit, RunsIntoOneFolderWaitForEachOther) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& name) {
    KitLight light{-45, 35, SphereGuides(8)};
    light.name = name;
    return WriteSphereKit(folder.path(), {light});
  };
  const int other = ::open(folder.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  std::thread run([&] { EXPECT_TRUE(write("late")); });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(fs::exists(folder / "late-template.png"));
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "[[exemplar]]\nimage = \"early.png\"\n").ok());
  ::close(other);
  run.join();
  const auto bytes = ReadWholeFile(folder / "style.toml");
  ASSERT_TRUE(bytes);
  const std::string style(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  EXPECT_NE(style.find("early.png"), std::string::npos) << style;
  EXPECT_NE(style.find("late.png"), std::string::npos) << style;
}

TEST(SphereKit, TheTemplateShowsTheLitSphereAndMarksOnlyTheMargin) {
  for (int size : {1, 2, 7, 8, 9, 33, 64, 255, 512}) {
    const Picture picture = DrawTemplate({-45, 35, SphereGuides(size)});
    const int margin = TemplateMargin(size);
    ASSERT_GE(margin, 1);
    ASSERT_EQ(picture.width, size + 2 * margin);
    ASSERT_EQ(picture.height, size + 2 * margin);
    // The same sphere in the dark, everywhere transparent: only the marks are drawn.
    GuideSet nothing = SphereGuides(size);
    for (float& coverage : nothing.Plane(Layer::kCoverage)) coverage = 0.0f;
    const Picture marks = DrawTemplate({-45, 35, nothing});
    for (std::uint16_t value : InnerSquare(marks, margin).rgba)
      ASSERT_EQ(value, 65535) << "a mark inside, size " << size;
    if (size >= 33 && size < 128) {
      EXPECT_EQ(marks.At(margin / 2, margin / 2)[0], 0) << "the cross in the corner";
      EXPECT_EQ(marks.At(size + 2 * margin - margin / 2 - 1, margin / 2)[0], 0) << "and in the next";
    }
    EXPECT_EQ(FiducialsInPlace(picture, size, margin), size < 128 ? 0 : kFiducialCount) << size;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) ASSERT_EQ(picture.rgba[i], 65535) << "paper is opaque";
  }
  const Picture picture = DrawTemplate({-45, 35, SphereGuides(64)});
  const int margin = TemplateMargin(64);
  EXPECT_GT(picture.At(margin + 18, margin + 18)[0], picture.At(margin + 46, margin + 46)[0])
      << "lit from the upper left";
  EXPECT_GT(picture.At(margin + 46, margin + 46)[0], 0) << "form shows in the shade";
  EXPECT_EQ(picture.At(margin, margin)[0], 65535) << "outside the disc";
}

TEST(SphereKit, FromTemplateToStyle) {
  const TemporaryFolder folder;
  const auto written = WriteSphereKit(folder / "mine", {KitLight{-45, 35, SphereGuides(64)}});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->size(), 6u);
  for (const fs::path& path : *written) EXPECT_TRUE(fs::is_regular_file(path)) << path;
  ExpectRefusal(LoadStyle(folder / "mine"), ErrorKind::kInput, {"lit.png", "not there yet", "template.png"});

  fs::copy_file(folder / "mine/template.png", folder / "mine/lit.png");
  const auto whole = LoadStyle(folder / "mine");
  ASSERT_TRUE(whole) << whole.error().message;
  const auto painted = ReadPicture(folder / "mine/template.png");
  ASSERT_TRUE(painted);
  const Picture inner = InnerSquare(*painted, TemplateMargin(64));
  ASSERT_EQ(whole->exemplars.at(0).picture.width, 64);
  EXPECT_EQ(whole->exemplars.at(0).picture.rgba, inner.rgba);
  EXPECT_EQ(whole->transfer.threshold, TransferSettings().threshold) << "the starter file only repeats defaults";
  EXPECT_EQ(whole->transfer.blend_radius, TransferSettings().blend_radius);
  EXPECT_EQ(whole->transfer.scale, TransferSettings().scale);
  EXPECT_FALSE(whole->paper.color || whole->paper.picture);

  ASSERT_TRUE(WritePicture(folder / "mine/lit.png", inner));
  const auto alone = LoadStyle(folder / "mine");
  ASSERT_TRUE(alone) << alone.error().message;
  EXPECT_EQ(alone->exemplars.at(0).picture.rgba, inner.rgba);

  for (const auto& [width, height] : {std::pair{64, 80}, {80, 64}, {65, 65}, {79, 79}, {160, 160}}) {
    ASSERT_TRUE(WritePicture(folder / "mine/lit.png", RandomPicture(width, height)));
    ExpectRefusal(
        LoadStyle(folder / "mine"), ErrorKind::kInput,
        {"lit.png is " + std::to_string(width) + "×" + std::to_string(height), "guides.exr", "64×64", "80×80"});
  }
}

std::string TextOf(const fs::path& file) {
  const auto bytes = ReadWholeFile(file);
  EXPECT_TRUE(bytes);
  return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : "";
}

TEST(SphereKit, AnArtistsStyleFileIsKept) {
  for (const std::string mine : {"[[exemplar]]\nimage = 'ball.png'\n", "# mine\n[transfer]\nmethod = 'toon'\n",
                                 "[[exemplar]]\nimage = 'lit.png'\nguides = './guides.exr'\n"}) {
    const TemporaryFolder folder;
    ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", mine));
    const auto written = WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16)}});
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(written->size(), 5u) << "what was kept is not listed as written";
    EXPECT_EQ(TextOf(folder / "style.toml"), mine);
    const bool lists = mine.find("guides.exr") != std::string::npos;
    EXPECT_EQ(UnlistedGuides(folder.path(), *written).size(), lists ? 0u : 1u) << mine;
  }
}

TEST(SphereKit, AStyleFileWithoutExemplarsGetsThoseOfTheKit) {
  const TemporaryFolder folder;
  const std::string mine = "# image = \"lit.png\"\nname = 'mine'";
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", mine));
  ASSERT_TRUE(WritePicture(folder / "lit.png", RandomPicture(16, 16)));
  ExpectRefusal(LoadStyle(folder.path()), {"add [[exemplar]] and image = \"lit.png\" under it"});
  const auto written = WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16)}});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(TextOf(folder / "style.toml").rfind(mine + "\n", 0), 0u);
  EXPECT_TRUE(UnlistedGuides(folder.path(), *written).empty());
  const auto style = LoadStyle(folder.path());
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->exemplars.at(0).guides_file.filename(), "guides.exr");
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", mine));
  ExpectRefusal(LoadStyle(folder.path()), {"[[exemplar]], image = \"lit.png\" and guides = \"guides.exr\" under it"});
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "name = \n"));
  ExpectRefusal(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16)}}), {"style.toml:1", "TOML"});
  // A new file lists four lights, the fifth as a comment.
  const TemporaryFolder many;
  const auto five = WriteSphereKit(many.path(), std::vector<KitLight>(5, KitLight{0, 0, SphereGuides(16)}));
  ASSERT_TRUE(five) << five.error().message;
  EXPECT_TRUE(UnlistedGuides(many.path(), *five).empty());
}

TEST(SphereKit, ALightMustNotTakeThePaintingOfAnother) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16)}}));
  const std::vector<std::string> before = folder.List();
  ExpectRefusal(WriteSphereKit(folder.path(), {KitLight{120, -10, SphereGuides(16), "lit"}}), ErrorKind::kOutput,
                {"style.toml lists lit.png with guides.exr", "lit-guides.exr", "--name"});
  EXPECT_EQ(folder.List(), before);
}

TEST(SphereKit, FurtherLightsGetFilesOfTheirOwn) {
  const TemporaryFolder folder;
  const auto written =
      WriteSphereKit(folder.path(), {KitLight{-45, 35, SphereGuides(16)}, KitLight{60, 10, SphereGuides(16)}});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(folder.List(), (std::vector<std::string>{"HOWTO.txt", "guides-2.exr", "guides.exr", "style.toml",
                                                     "template-2.ora", "template-2.pdf", "template-2.png",
                                                     "template.ora", "template.pdf", "template.png"}));
  const auto howto = ReadWholeFile(folder / "HOWTO.txt");
  ASSERT_TRUE(howto);
  const std::string text(reinterpret_cast<const char*>(howto->data()), howto->size());
  EXPECT_NE(text.find("azimuth -45, elevation 35"), std::string::npos);
  EXPECT_NE(text.find("azimuth 60, elevation 10"), std::string::npos);
}

TEST(SphereKit, ATemplateIsRecognisedAtEverySizeAndOtherPicturesAreNot) {
  for (int size : {63, 64, 65, 127, 128, 200, 511, 512}) {
    const KitLight light{-40, 40, SphereGuides(size)};
    const Picture drawn = DrawTemplate(light);
    EXPECT_TRUE(LooksLikeTemplate(drawn)) << size;
    EXPECT_TRUE(LooksLikeTemplate(DrawTemplateWithCrosses(light))) << "as it once was, " << size;
    EXPECT_FALSE(LooksLikeTemplate(InnerSquare(drawn, TemplateMargin(size)))) << size;
    EXPECT_FALSE(LooksLikeTemplate(RandomPicture(drawn.width, drawn.width))) << size;
  }
  // Exported at the sphere's size: scaled as a whole, margin included.
  const Picture whole = DrawTemplate({-40, 40, SphereGuides(1024)});
  for (const int side : {1280, 1024, 641, 512, 300}) {
    Picture scaled(side, side);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        // The mean of what the pixel covers, of whole pixels.
        const int x0 = x * 1280 / side, x1 = std::max(x0 + 1, (x + 1) * 1280 / side);
        const int y0 = y * 1280 / side, y1 = std::max(y0 + 1, (y + 1) * 1280 / side);
        std::uint32_t sum = 0;
        for (int j = y0; j < y1; ++j) {
          for (int i = x0; i < x1; ++i) sum += whole.At(i, j)[1];
        }
        std::fill_n(scaled.At(x, y), 3, static_cast<std::uint16_t>(sum / std::uint32_t((x1 - x0) * (y1 - y0))));
        scaled.At(x, y)[3] = 65535;
      }
    }
    EXPECT_EQ(FiducialsInProportion(scaled), kFiducialCount) << side;
    EXPECT_TRUE(LooksLikeTemplate(scaled)) << side;
    Picture mirrored = scaled;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) std::copy_n(scaled.At(x, y), 4, mirrored.At(side - 1 - x, y));
    }
    EXPECT_TRUE(LooksLikeTemplate(mirrored)) << side;
    EXPECT_EQ(FiducialsInProportion(InnerSquare(scaled, side / 10)), 0) << side;
  }
  // Paint that runs over some marks leaves the others.
  Picture painted = DrawTemplate({-40, 40, SphereGuides(256)});
  std::fill_n(painted.At(0, 0), 4 * painted.width * (TemplateMargin(256) + 60), std::uint16_t{30000});
  EXPECT_TRUE(LooksLikeTemplate(painted));
  EXPECT_FALSE(LooksLikeTemplate(Picture()));
  EXPECT_FALSE(LooksLikeTemplate(Picture(1, 1)));
  EXPECT_FALSE(LooksLikeTemplate(Picture(30, 20)));
}

TEST(SphereKit, ATemplateNamedAsAStyleIsRefusedAndAPaintingStandsForItsFolder) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(64)}}));
  ExpectRefusal(LoadStyle(folder / "template.png"), ErrorKind::kInput, {"template.png", "whole template", "folder"});
  ExpectRefusal(LoadStyle(folder.path()), ErrorKind::kInput, {"lit.png", "paint over", "template.png"});
  std::filesystem::copy_file(folder / "template.png", folder / "lit.png");
  const auto style = LoadStyle(folder / "lit.png");
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_EQ(style->exemplars[0].picture.width, 64) << "without the margin";
  // Without its guides nobody knows the margin, whether the file is named or the folder.
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "[[exemplar]]\nimage = 'lit.png'\n"));
  for (const fs::path& named : {folder.path(), folder / "lit.png"}) {
    ExpectRefusal(LoadStyle(named), {"lit.png is a whole template", "guides = \"guides.exr\"", "crop"});
  }
  fs::remove(folder / "guides.exr");
  ExpectRefusal(LoadStyle(folder.path()), {"lit.png is a whole template", "crop", "or write the guides"});
  EXPECT_TRUE(LoadStyle(folder.path(), *ParseStyleOverrides({"exemplar.1.fills=true"})));
}

TEST(SphereKit, APaintedTemplateIsNotOverwritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}}));
  EXPECT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}})) << "the same may be written again";
  Picture painted = DrawTemplate({0, 0, SphereGuides(32)});
  painted.At(20, 20)[0] = 40000;
  ASSERT_TRUE(WritePicture(folder / "template.png", painted));
  const auto before = ReadPicture(folder / "template.png");
  ExpectRefusal(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}}), ErrorKind::kOutput,
                {"template.png", "painting"});
  EXPECT_EQ(ReadPicture(folder / "template.png")->rgba, before->rgba);
}

TEST(SphereKit, ATemplateWithTheCrossesOfOldIsDrawnAnew) {
  const TemporaryFolder folder;
  const KitLight light{0, 0, SphereGuides(128)};
  ASSERT_TRUE(WritePicture(folder / "template.png", DrawTemplateWithCrosses(light)));
  const auto written = WriteSphereKit(folder.path(), {light});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(FiducialsInPlace(*ReadPicture(folder / "template.png"), 128, TemplateMargin(128)), kFiducialCount);
}

TEST(SphereKit, PaintedLayersAreNotOverwritten) {
  const TemporaryFolder folder;
  const auto kit = [&](int dpi) {
    KitOptions options;
    options.dpi = dpi;
    return WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(32)}}, options);
  };
  ASSERT_TRUE(kit(300));
  EXPECT_TRUE(kit(300)) << "the same may be written again";
  EXPECT_TRUE(kit(150)) << "and for other paper: nobody has painted on it";
  // Layers as another program names and numbers them; their composite is equal but for a dot of paint.
  Picture paint(48, 48), merged = DrawTemplate({0, 0, SphereGuides(32)});
  for (std::uint16_t* pixel : {paint.At(20, 20), merged.At(20, 20)}) pixel[0] = 40000, pixel[3] = 65535;
  const auto saved = EncodeOpenRaster(std::vector<RasterLayer>{{"mine", *EncodePng(paint)}}, merged, 0, "template.ora");
  ASSERT_TRUE(saved);
  ASSERT_TRUE(WriteFileAtomically(folder / "template.ora", *saved));
  ExpectRefusal(kit(300), ErrorKind::kOutput, {"template.ora", "painting"});
  EXPECT_EQ(*ReadWholeFile(folder / "template.ora"), *saved);
  // Nor are they by a template of another size that comes without layers: the guides would no longer fit.
  std::filesystem::remove(folder / "template.png");
  KitOptions png;
  png.ora = png.pdf = false;
  ExpectRefusal(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(64)}}, png), ErrorKind::kOutput,
                {"guides.exr is of 32²", "template.ora", "--size 32"});
}

TEST(SphereKit, GuidesAndPaintingsByTheirNames) {
  const TemporaryFolder folder;
  const auto guides = [&](const std::string& painting) {
    const auto found = GuidesOfPainting(folder / painting);
    return found ? found->filename().string() : "none";
  };
  EXPECT_EQ(guides("lit.png"), "none");
  const KitLight first{0, 0, SphereGuides(16)}, second{60, 10, SphereGuides(16)};
  ASSERT_TRUE(WriteSphereKit(folder.path(), {first, second}));
  EXPECT_EQ(guides("lit.png"), "guides.exr");
  EXPECT_EQ(guides("lit-2.png"), "guides-2.exr");
  EXPECT_EQ(guides("lit-evening.png"), "none");
  EXPECT_EQ(guides("literal.png"), "none");
  fs::remove(folder / "style.toml");  // it lists lit.png with guides.exr
  for (const char* name : {"lit", "lit-evening", "shade"}) {
    ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16), name}}));
    EXPECT_EQ(guides(std::string(name) + ".png"), std::string(name) + "-guides.exr");
  }
  EXPECT_EQ(PaintingOfTemplate("template"), "lit");
  EXPECT_EQ(PaintingOfTemplate("template-2"), "lit-2");
  EXPECT_EQ(PaintingOfTemplate("shade-template"), "shade");
  for (const char* name : {"lit", "my-templates", "templates", "template-a", "contemplate", ""}) {
    EXPECT_FALSE(PaintingOfTemplate(name)) << name;
  }
}

TEST(SphereKit, AHiddenLayerThatWasPaintedCountsToo) {
  const TemporaryFolder folder;
  const KitLight light{0, 0, SphereGuides(32)};
  ASSERT_TRUE(WriteSphereKit(folder.path(), {light}));
  // The layers as they are in the file, one of them changed, and the merged picture the same.
  const auto zip = ZipReader::Open(folder / "template.ora");
  ASSERT_TRUE(zip);
  std::vector<ZipEntry> entries;
  for (const std::string& name : zip->names()) entries.push_back({name, *zip->Read(name, 1 << 20)});
  const auto rewrite = [&] {
    const auto saved = EncodeZip(entries, "template.ora");
    return WriteFileAtomically(folder / "template.ora", *saved);
  };
  ASSERT_TRUE(rewrite());
  EXPECT_TRUE(WriteSphereKit(folder.path(), {light})) << "nothing was painted";
  Picture paint(40, 40);
  paint.At(3, 3)[3] = 65535;
  const auto layer = std::find_if(entries.begin(), entries.end(),
                                  [](const ZipEntry& entry) { return entry.name == "data/layer01.png"; });
  ASSERT_NE(layer, entries.end());
  layer->bytes = *EncodePng(paint);
  ASSERT_TRUE(rewrite());
  ExpectRefusal(WriteSphereKit(folder.path(), {light}), ErrorKind::kOutput, {"template.ora", "painting"});
}

TEST(SphereKit, APageThatAnotherProgramHasChangedIsKept) {
  const TemporaryFolder folder;
  const std::vector<KitLight> lights = {{0, 0, SphereGuides(32)}};
  ASSERT_TRUE(WriteSphereKit(folder.path(), lights));
  const std::vector<std::byte> page = *ReadWholeFile(folder / "template.pdf");
  EXPECT_TRUE(IsTemplatePdf(page));
  std::vector<std::byte> noted = page;
  for (const char c : std::string("\n1 0 obj\n<<>>\nendobj\n%%EOF\n")) noted.push_back(std::byte(c));
  EXPECT_FALSE(IsTemplatePdf(noted)) << "something was added behind its end";
  EXPECT_FALSE(IsTemplatePdf({}));
  ASSERT_TRUE(WriteFileAtomically(folder / "template.pdf", noted));
  ExpectRefusal(WriteSphereKit(folder.path(), lights), ErrorKind::kOutput, {"template.pdf", "another program"});
  EXPECT_EQ(*ReadWholeFile(folder / "template.pdf"), noted);
}

TEST(SphereKit, APaintingInLayersIsAnExemplar) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{-45, 35, SphereGuides(64)}}));
  const auto toml = ReadWholeFile(folder / "style.toml");
  std::string text(reinterpret_cast<const char*>(toml->data()), toml->size());
  text.replace(text.find("image = \"lit.png\""), 17, "image = \"template.ora\"");
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", text));
  const auto layered = LoadStyle(folder.path());
  ASSERT_TRUE(layered) << layered.error().message;
  EXPECT_EQ(layered->exemplars[0].picture.width, 64) << "without the margin";
  fs::copy_file(folder / "template.png", folder / "lit.png");
  fs::copy_file(folder / "template.ora", folder / "lit-2.ora");
  ASSERT_TRUE(WriteFileAtomically(folder / "other.toml", "[[exemplar]]\nimage = 'lit-2.png'\n"));
  ExpectRefusal(LoadStyle(folder / "other.toml"), ErrorKind::kInput,
                {"lit-2.png is not there", "image = \"lit-2.ora\"", "other.toml"});
  text.replace(text.find("template.ora\""), 12, "lit.png");
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", text));
  const auto flat = LoadStyle(folder.path());
  ASSERT_TRUE(flat) << flat.error().message;
  EXPECT_EQ(layered->exemplars[0].picture.rgba, flat->exemplars[0].picture.rgba);
}

TEST(SphereKit, ALightThatIsListedByItsLayersIsNotListedTwice) {
  const TemporaryFolder folder;
  const std::string mine = "[[exemplar]]\nimage = \"shade-template.ora\"\nguides = \"shade-guides.exr\"\n";
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", mine));
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16), "shade"}}));
  const auto kept = ReadWholeFile(folder / "style.toml");
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(kept->data()), kept->size()), mine);
}

TEST(SphereKit, OnlyWhatIsAskedForIsWritten) {
  for (const auto& [png, ora, pdf] :
       {std::tuple{true, false, false}, {false, true, false}, {false, false, true}, {true, true, false}}) {
    const TemporaryFolder folder;
    KitOptions options;
    options.png = png, options.ora = ora, options.pdf = pdf;
    ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(16)}}, options));
    EXPECT_EQ(fs::exists(folder / "template.png"), png);
    EXPECT_EQ(fs::exists(folder / "template.ora"), ora);
    EXPECT_EQ(fs::exists(folder / "template.pdf"), pdf);
    const auto howto = ReadWholeFile(folder / "HOWTO.txt");
    const std::string text(reinterpret_cast<const char*>(howto->data()), howto->size());
    EXPECT_EQ(text.find("template.png is for") != std::string::npos, png);
    EXPECT_EQ(text.find("template.ora is for") != std::string::npos, ora);
    EXPECT_EQ(text.find("template.pdf is for") != std::string::npos, pdf);
  }
}

TEST(SphereKit, WhereTheLightComesFromInWords) {
  const auto place = [](double azimuth, double elevation) { return PlaceInWords({azimuth, elevation, {}}); };
  EXPECT_EQ(place(-40, 40), "the upper left");
  EXPECT_EQ(place(40, -40), "the lower right");
  EXPECT_EQ(place(0, 90), "above");
  EXPECT_EQ(place(90, 0), "the right");
  EXPECT_EQ(place(0, 0), "the viewer");
  EXPECT_EQ(place(120, -10), "the right, behind the sphere");
  EXPECT_EQ(place(180, 0), "behind");
}

TEST(SphereKit, TheMarginIsInTheGuides) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteSphereKit(folder.path(), {KitLight{0, 0, SphereGuides(20)}}));
  const auto guides =
      ReadGuides(folder / "guides.exr", {{Layer::kCoverage, Layer::kNormal, Layer::kLuminance}, {}, "", "", {}, {}});
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(SphereMargin(*guides), TemplateMargin(20));
  EXPECT_FALSE(SphereMargin(SphereGuides(20))) << "guides of no kit";
  GuideSet odd = SphereGuides(20);
  for (const char* bad : {"-1", "21", "nonsense", "", "3 apples", "99999999999999999999"}) {
    odd.attributes["scumble:sphereMargin"] = bad;
    EXPECT_FALSE(SphereMargin(odd)) << bad;
  }
}

TEST(SphereKit, GuidesOfAnotherProgramAreASceneOfTheirOwn) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WritePicture(folder / "lit.png", RandomPicture(16, 16)));
  ASSERT_TRUE(WriteGuides(folder / "other.exr", SphereGuides(16)));
  ASSERT_TRUE(WriteFileAtomically(folder / "style.toml", "[[exemplar]]\nimage = 'lit.png'\nguides = 'other.exr'\n"));
  const auto style = LoadStyle(folder.path());
  ASSERT_TRUE(style) << style.error().message;
  EXPECT_FALSE(style->exemplars[0].is_sphere);
  ASSERT_TRUE(style->exemplars[0].guides);
  EXPECT_EQ(style->exemplars[0].guides->width(), 16);
}

TEST(SphereKit, AnUnwritableFolderIsAnOutputError) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "file", "x"));
  ExpectRefusal(WriteSphereKit(folder / "file/kit", {KitLight{0, 0, SphereGuides(16)}}), ErrorKind::kOutput, {"file"});
}

}  // namespace
}  // namespace scumble
