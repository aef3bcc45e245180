#include "measure/html_page.h"

#include <cstdint>

namespace scumble::internal {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --text: #23252b; --soft: #676b75; --ground: #f7f7f8; --card: #fff; --line: #dcdde2;
  --good: #1f7a4a; --bad: #b3261e; --warn: #8a5a00; --badground: #fbeae8; }
@media (prefers-color-scheme: dark) { :root { --text: #e4e5e9; --soft: #9a9eaa; --ground: #17181b; --card: #202226;
  --line: #35373e; --good: #4dbb82; --bad: #ff8a80; --warn: #e5b04a; --badground: #3a2221; } }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 80rem; padding: 0 1.2rem; color: var(--text);
  background: var(--ground); }
h1 { font-weight: 600; margin-bottom: .3rem; } h2 { margin: 3rem 0 .2rem; font-weight: 600; }
h3 { margin: 1.8rem 0 .4rem; font-size: 1rem; }
p { margin: .3rem 0; } .soft { color: var(--soft); } a { color: inherit; }
section { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: .2rem 1.2rem .8rem;
  margin: .8rem 0; overflow-x: auto; }
table { border-collapse: collapse; margin: .6rem 0; } th { font-weight: 600; color: var(--soft); font-size: .85rem; }
th, td { text-align: left; padding: .28rem 1.4rem .28rem 0; border-bottom: 1px solid var(--line);
  vertical-align: baseline; }
tr:last-child td { border-bottom: 0; }
th.number, td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
ul { margin: .2rem 0; padding-left: 1.2rem; }
img { width: 100%; border-radius: 4px; background: repeating-conic-gradient(#8884 0 25%, #8882 0 50%) 0 0 / 16px 16px;
  display: block; }
figcaption { color: var(--soft); font-size: .82rem; padding-top: .25rem; }
code { background: var(--card); border: 1px solid var(--line); padding: .05rem .35rem; border-radius: 3px;
  overflow-wrap: anywhere; }
)";

}  // namespace

std::string EscapeHtml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else if (c == '\'')
      escaped += "&#39;";
    else
      escaped += c;
  }
  return escaped;
}

std::string Base64(std::span<const std::byte> bytes) {
  constexpr const char* kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      word = word << 8 | (i + b < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + b]) : 0u);
    }
    for (std::size_t b = 0; b < 4; ++b) {
      text += i + b <= bytes.size() ? kAlphabet[word >> (18 - 6 * b) & 63u] : '=';
    }
  }
  return text;
}

std::string PngAddress(std::span<const std::byte> png) { return "data:image/png;base64," + Base64(png); }

std::string PageHead(const std::string& title, const std::string& style) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
         "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n<title>" +
         EscapeHtml(title) + "</title>\n<style>\n" + kStyle + style + "</style></head><body>\n";
}

}  // namespace scumble::internal
