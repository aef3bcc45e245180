#include "core/style/kit/template_pdf.h"

#include <hpdf.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string_view>
#include <type_traits>

#include "core/image/direction.h"
#include "core/style/fiducials.h"

namespace scumble {
namespace {

constexpr const char* kCreator = "scumble sphere";
constexpr double kPointsPerInch = 72.0, kPointsPerMm = 72.0 / 25.4;

struct FreeDocument {
  void operator()(HPDF_Doc document) const { HPDF_Free(document); }
};
using Document = std::unique_ptr<std::remove_pointer_t<HPDF_Doc>, FreeDocument>;

HPDF_REAL Real(double value) { return static_cast<HPDF_REAL>(value); }

// A page with coordinates in the template's pixels, from the template's upper left corner, y down.
class PdfSheet {
 public:
  PdfSheet(HPDF_Page page, const PrintPage& place, int dpi)
      : page_(page), place_(place), scale_(kPointsPerInch / dpi), height_(place.height_mm * kPointsPerMm) {
    HPDF_Page_SetWidth(page, Real(place.width_mm * kPointsPerMm));
    HPDF_Page_SetHeight(page, Real(height_));
  }
  HPDF_Page page() const { return page_; }
  HPDF_REAL X(double x) const { return Real((place_.left + x) * scale_); }
  HPDF_REAL Y(double y) const { return Real(height_ - (place_.top + y) * scale_); }
  HPDF_REAL Length(double pixels) const { return Real(pixels * scale_); }

  void Box(double x0, double y0, double x1, double y1, double grey) const {
    HPDF_Page_SetGrayFill(page_, Real(grey));
    HPDF_Page_Rectangle(page_, X(x0), Y(y1), Length(x1 - x0), Length(y1 - y0));
    HPDF_Page_Fill(page_);
  }

 private:
  HPDF_Page page_;
  const PrintPage& place_;
  double scale_, height_;
};

// The sphere, 0 to 18% grey with a thin line around it: paint covers it, and a pencil line shows on it.
void DrawPaleSphere(HPDF_Doc document, const PdfSheet& sheet, const KitLight& light) {
  const Picture lit = DrawLitSphere(light);
  const int size = light.guides.width(), margin = TemplateMargin(size);
  std::vector<HPDF_BYTE> grey;
  grey.reserve(std::size_t(size) * size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      grey.push_back(static_cast<HPDF_BYTE>(255.0 * PaleGrey(lit.At(margin + x, margin + y)) + 0.5));
    }
  }
  const HPDF_Image image = HPDF_LoadRawImageFromMem(document, grey.data(), static_cast<HPDF_UINT>(size),
                                                    static_cast<HPDF_UINT>(size), HPDF_CS_DEVICE_GRAY, 8);
  // Slightly smaller than its place: readers paint every pixel that a picture touches, and its edges rarely fall on
  // pixel edges.
  constexpr double kHair = 0.02;
  HPDF_Page_DrawImage(sheet.page(), image, sheet.X(margin + kHair), sheet.Y(margin + size - kHair),
                      sheet.Length(size - 2 * kHair), sheet.Length(size - 2 * kHair));
  // Towards the light the sphere is as white as the paper.
  constexpr double kLineMm = 0.2, kLineGrey = 0.72;
  HPDF_Page_SetGrayStroke(sheet.page(), Real(kLineGrey));
  HPDF_Page_SetLineWidth(sheet.page(), Real(kLineMm * kPointsPerMm));
  HPDF_Page_Circle(sheet.page(), sheet.X(margin + size / 2.0), sheet.Y(margin + size / 2.0), sheet.Length(size / 2.0));
  HPDF_Page_Stroke(sheet.page());
}

void DrawPrintedMarks(const PdfSheet& sheet, int size) {
  const int margin = TemplateMargin(size);
  for (const TemplateMark& mark : PlainMarks(size)) sheet.Box(mark.x0, mark.y0, mark.x1, mark.y1, mark.grey / 65535.0);
  if (!FiducialsFit(size)) return;
  const double module = kFiducialModule * size;
  for (const Fiducial& mark : Fiducials()) {
    const double left = margin + mark.left * size, top = margin + mark.top * size;
    for (int row = 0; row < kFiducialModules; ++row) {
      // Black modules side by side are one box: some printers leave a hairline between two boxes.
      for (int column = 0; column < kFiducialModules;) {
        int end = column;
        while (end < kFiducialModules && FiducialIsBlack(mark.id, end, row)) ++end;
        if (end > column)
          sheet.Box(left + column * module, top + row * module, left + end * module, top + (row + 1) * module, 0);
        column = end + 1;
      }
    }
  }
}

// The page's letters are those of Western Europe; other letters of a file's name become '_'.
std::string WesternLetters(const std::string& utf8) {
  std::string text;
  for (std::size_t i = 0; i < utf8.size(); ++i) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const auto next = i + 1 < utf8.size() ? static_cast<unsigned char>(utf8[i + 1]) : 0u;
    if (lead < 0x80) {
      text += utf8[i];
    } else if ((lead == 0xc2 || lead == 0xc3) && (next & 0xc0) == 0x80 && (lead == 0xc3 || next >= 0xa0)) {
      text += static_cast<char>(lead == 0xc3 ? next + 0x40 : next);
      ++i;
    } else if ((lead & 0xc0) == 0xc0) {
      text += '_';  // the first byte of a letter; its further bytes are dropped
    }
  }
  return text;
}

std::vector<std::string> CaptionLines(const KitLight& light, int dpi, const std::string& painting) {
  char size_text[160];
  const double across = MillimetresOf(light.guides.width(), dpi);
  std::snprintf(size_text, sizeof size_text, "The sphere is %.1f mm (%.2f in) across: %d pixels at %d dpi.", across,
                across / 25.4, light.guides.width(), dpi);
  const int size = light.guides.width();
  const std::string scan = FiducialsFit(size)
                               ? "4. scumble sphere --rectify scan.jpg -o " + painting +
                                     "   makes the painting for style.toml out of the scan."
                               : "4. The sphere is too small for the marks that lay a scan straight: cut " + painting +
                                     " out of the scan by hand.";
  return {"The light comes from " + PlaceInWords(light) + ": " + AnglesInWords(light) + ".",
          std::string(size_text),
          "1. Print at 100% (\"actual size\", not fitted to the page). The line below is 50 mm long: measure it.",
          "2. Paint over the sphere, past its edge all round. Keep the black marks and the white around them free of "
          "paint.",
          "3. When it is dry, scan the whole page, all marks in sight, at " + std::to_string(ScanDpi(size, dpi)) +
              " dpi or more. Or photograph it in even light.",
          scan};
}

void DrawScaleBar(const PdfSheet& sheet, double left, double top, double pixels_per_mm) {
  constexpr double kBarMm = 50.0, kLineMm = 0.25, kTickMm = 3.0;
  const double line = kLineMm * pixels_per_mm, right = left + kBarMm * pixels_per_mm;
  sheet.Box(left, top - line / 2, right, top + line / 2, 0);
  for (const double end : {left, right - line}) {
    sheet.Box(end, top - kTickMm / 2 * pixels_per_mm, end + line, top + kTickMm / 2 * pixels_per_mm, 0);
  }
}

void DrawWords(HPDF_Doc document, const PdfSheet& sheet, const KitLight& light, const PrintPage& page, int dpi,
               const std::string& painting) {
  const double pixels_per_mm = dpi / 25.4;
  const int size = light.guides.width(), side = size + 2 * TemplateMargin(size);
  // Aligned with the template's left side, but never so far right that the longest line would leave the page.
  constexpr double kWidestMm = 168.0;
  const double room = page.width_mm - kPageEdgeMm - kWidestMm;
  const double left = std::min(0.0, room * pixels_per_mm - page.left);
  const HPDF_Font plain = HPDF_GetFont(document, "Helvetica", "WinAnsiEncoding");
  const HPDF_Font bold = HPDF_GetFont(document, "Helvetica-Bold", "WinAnsiEncoding");
  double y = side + 9.0 * pixels_per_mm;
  const auto write = [&](HPDF_Font font, double points, const std::string& text, double feed_mm) {
    HPDF_Page_SetGrayFill(sheet.page(), 0);
    HPDF_Page_BeginText(sheet.page());
    HPDF_Page_SetFontAndSize(sheet.page(), font, Real(points));
    HPDF_Page_TextOut(sheet.page(), sheet.X(left), sheet.Y(y), text.c_str());
    HPDF_Page_EndText(sheet.page());
    y += feed_mm * pixels_per_mm;
  };
  write(bold, 12, "A sphere to paint over: " + painting, 6.5);
  for (const std::string& line : CaptionLines(light, dpi, painting)) write(plain, 9, line, 5.0);
  DrawScaleBar(sheet, left, y + 1.5 * pixels_per_mm, pixels_per_mm);
}

Expected<std::vector<std::byte>> Save(HPDF_Doc document, const std::string& name) {
  if (HPDF_GetError(document) == HPDF_OK) HPDF_SaveToStream(document);
  const HPDF_STATUS failed = HPDF_GetError(document);
  if (failed != HPDF_OK) {
    char code[64];
    std::snprintf(code, sizeof code, "libharu's error 0x%04lX", static_cast<unsigned long>(failed));
    return OutputError("cannot write " + name + ": " + code);
  }
  HPDF_UINT32 count = HPDF_GetStreamSize(document);
  std::vector<std::byte> bytes(count);
  HPDF_ReadFromStream(document, reinterpret_cast<HPDF_BYTE*>(bytes.data()), &count);
  bytes.resize(count);
  return bytes;
}

}  // namespace

Expected<std::vector<std::byte>> EncodeTemplatePdf(const KitLight& light, const PrintPage& page, int dpi,
                                                   const std::string& painting, const std::string& name) {
  // Without an error handler the library notes the first error and ignores all later calls.
  const Document document(HPDF_New(nullptr, nullptr));
  if (!document) return OutputError("cannot write " + name + ": out of memory");
  HPDF_SetCompressionMode(document.get(), HPDF_COMP_ALL);
  HPDF_SetInfoAttr(document.get(), HPDF_INFO_CREATOR, kCreator);
  HPDF_SetInfoAttr(document.get(), HPDF_INFO_TITLE, "A sphere to paint over");
  HPDF_SetViewerPreference(document.get(), HPDF_PRINT_SCALING_NONE);
  const PdfSheet sheet(HPDF_AddPage(document.get()), page, dpi);
  DrawPaleSphere(document.get(), sheet, light);
  DrawPrintedMarks(sheet, light.guides.width());
  DrawWords(document.get(), sheet, light, page, dpi, WesternLetters(painting));
  return Save(document.get(), name);
}

bool IsTemplatePdf(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t end = text.find("%%EOF");
  // A program that rewrites the file leaves its own name in it; one that appends to it leaves a second end.
  return text.substr(0, 5) == "%PDF-" && text.find(std::string("(") + kCreator + ")") != std::string_view::npos &&
         text.find("(Haru Free PDF Library") != std::string_view::npos && end != std::string_view::npos &&
         text.size() - end < 8;
}

}  // namespace scumble
