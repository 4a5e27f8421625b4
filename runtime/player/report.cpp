// SPDX-License-Identifier: Apache-2.0
// A comparison as one HTML page.
#include "player/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "player/metrics/color_maps.h"

namespace chandelier::player {
namespace {

constexpr std::string_view page_style = R"(
:root { color-scheme: light dark; --line: #8884; --dim: #777; --a: #4a7fd1; --b: #d9822b; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1320px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin: 0; } h2 { font-size: 1.1rem; margin: 2.2rem 0 .6rem; }
p.about { color: var(--dim); margin: .2rem 0 1.4rem; }
table { border-collapse: collapse; }
th, td { padding: .25rem .8rem; border-bottom: 1px solid var(--line); text-align: left; }
th { font-weight: 600; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
tr.sum td { font-weight: 600; } td.other { background: #d9822b2a; }
img { display: block; width: 100%; height: auto; }
figure { margin: 0; } figcaption { color: var(--dim); padding-top: .3rem; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }
.slider { position: relative; } .slider .top { position: absolute; inset: 0; clip-path: inset(0 0 0 50%); }
.slider .edge { position: absolute; top: 0; bottom: 0; left: 50%; width: 2px; background: #fff; }
.slider input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0; }
.tag { position: absolute; top: .5rem; padding: 0 .6rem; background: #000a; color: #fff; border-radius: 3px; }
.columns { display: flex; flex-wrap: wrap; gap: 0 3rem; }
)";

constexpr std::string_view page_script = R"(
const slider = document.querySelector('.slider');
slider.querySelector('input').addEventListener('input', event => {
  slider.querySelector('.top').style.clipPath = `inset(0 0 0 ${event.target.value}%)`;
  slider.querySelector('.edge').style.left = `${event.target.value}%`;
});
)";

// A side's heading: its preset, told apart where both have the same.
std::string side_name(const Comparison& c, bool is_b) {
  const std::string name = escape_html((is_b ? c.b : c.a).preset);
  return c.a.preset == c.b.preset ? fmt::format("{} ({})", name, is_b ? 'B' : 'A') : name;
}

std::string with_separators(uint64_t number) {
  std::string text = std::to_string(number);
  for (ptrdiff_t at = static_cast<ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<size_t>(at), "\u202f");  // narrow no-break space
  return text;
}

std::string bytes_text(uint64_t bytes) {
  return bytes < 1024 ? fmt::format("{} B", bytes)
                      : fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
}

std::string ratio_text(double a, double b) {
  return a > 0.0 ? fmt::format("{:.2f}", b / a) : "–";
}

std::string pictures(const Comparison& c) {
  const std::string a = escape_html(c.a.image);
  const std::string b = escape_html(c.b.image);
  const std::string name_a = side_name(c, false);
  const std::string name_b = side_name(c, true);
  std::string html = fmt::format(
      "<h2>Pictures</h2>\n<div class=\"slider\"><img src=\"{0}\" alt=\"{2}\"><div class=\"top\"><img src=\"{1}\" "
      "alt=\"{3}\"></div><div class=\"edge\"></div><span class=\"tag\" style=\"left:.5rem\">{2}</span><span "
      "class=\"tag\" style=\"right:.5rem\">{3}</span><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
      "step=\"0.1\" aria-label=\"Drag to compare\"></div>\n<div class=\"pair\" style=\"margin-top:1rem\">\n",
      a, b, name_a, name_b);
  for (const Run* run : {&c.a, &c.b}) {
    html += fmt::format("<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\"></a><figcaption>{1}",
                        escape_html(run->image), run == &c.a ? name_a : name_b);
    if (!run->radiance.empty()) html += fmt::format(", <a href=\"{}\">linear radiance</a>", escape_html(run->radiance));
    html += "</figcaption></figure>\n";
  }
  return html + "</div>\n";
}

// The colours of a map, low to high, with the values they stand for.
std::string color_bar(std::string_view id, ColorMap colors, float scale) {
  std::string stops;
  for (int i = 0; i <= 16; ++i) {
    const auto [r, g, b] = colors(static_cast<float>(i) / 16.0f);
    stops += fmt::format("<stop offset=\"{}\" stop-color=\"rgb({},{},{})\"/>", i / 16.0, r, g, b);
  }
  std::string labels;
  for (int i = 0; i <= 4; ++i)
    labels += fmt::format(
        "<text x=\"{}\" y=\"34\" text-anchor=\"{}\" font-size=\"12\" fill=\"currentColor\">{:.3g}</text>", i * 90,
        i == 0   ? "start"
        : i == 4 ? "end"
                 : "middle",
        scale * static_cast<float>(i) / 4.0f);
  return fmt::format(
      "<svg width=\"360\" height=\"38\" role=\"img\" aria-label=\"Colour bar\"><defs><linearGradient id=\"{0}\">{1}"
      "</linearGradient></defs><rect width=\"360\" height=\"18\" fill=\"url(#{0})\"/>{2}</svg>",
      id, stops, labels);
}

std::string metric_row(std::string_view name, const std::string& shown, const std::string& linear,
                       std::string_view meaning) {
  return fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n", name, shown,
                     linear, meaning);
}

std::string metrics(const Differences& d) {
  const auto number = [](double value) { return fmt::format("{:.6f}", value); };
  return "<table style=\"margin-top:1rem\"><tr><th></th><th class=\"n\">shown</th><th class=\"n\">linear</th>"
         "<th>meaning</th></tr>\n" +
         metric_row("RMSE", number(d.rmse_shown), number(d.rmse_linear),
                    "Root of the mean squared difference over R, G and B of every pixel; 0 is equal.") +
         metric_row("largest", number(d.max_shown), number(d.max_linear),
                    "Largest difference over R, G and B of every pixel.") +
         metric_row(
             "SSIM", d.ssim ? number(*d.ssim) : "–", "",
             "Likeness of means, contrasts and structures in windows of 11×11 pixels (Wang et al. 2004), mean over "
             "R, G and B; 1 is equal.") +
         metric_row("FLIP", number(d.flip), "",
                    "Difference seen by a viewer who flips between the pictures 0.7 m before a screen 0.7 m and 3840 "
                    "pixels wide (Andersson et al. 2020), mean over the pixels; 0 is equal.") +
         "</table>\n<p class=\"about\">Shown: sRGB 0..1, as on a screen. Linear: radiance before exposure and tone "
         "map.</p>\n";
}

std::string difference(const Comparison& c) {
  return fmt::format(
             "<h2>Difference</h2>\n<div class=\"pair\">\n<figure><img src=\"{0}\" alt=\"Heat map of the "
             "difference\"><figcaption>{1}<br>Largest difference of R, G and B of the shown pictures (0..1) at each "
             "pixel; dark blue is none, red is {2:.3g} and more (0.1 % of the pixels at most lie "
             "above).</figcaption></figure>\n<figure><img src=\"{3}\" alt=\"Map of FLIP\"><figcaption>{4}<br>FLIP at "
             "each "
             "pixel.</figcaption></figure>\n</div>\n",
             escape_html(c.difference_image), color_bar("heat", heat_color, c.heat_scale), c.heat_scale,
             escape_html(c.flip_image), color_bar("magma", magma_color, 1.0f)) +
         metrics(c.differences);
}

const StageTime* find_stage(const Run& run, const std::string& name) {
  const auto& stages = run.stats.stages;
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const StageTime& s) { return s.name == name; });
  return found == stages.end() ? nullptr : &*found;
}

// A's stages in order, then those that only B has.
std::vector<std::string> stage_names(const Comparison& c) {
  std::vector<std::string> names;
  for (const Run* run : {&c.a, &c.b})
    for (const StageTime& stage : run->stats.stages)
      if (std::find(names.begin(), names.end(), stage.name) == names.end()) names.push_back(stage.name);
  return names;
}

std::string time_bars(double a_ms, double b_ms, double longest_ms) {
  const auto width = [longest_ms](double ms) { return longest_ms > 0.0 ? 300.0 * ms / longest_ms : 0.0; };
  return fmt::format(
      "<svg width=\"300\" height=\"18\"><rect width=\"{:.1f}\" height=\"8\" fill=\"#4a7fd1\"/><rect y=\"9\" "
      "width=\"{:.1f}\" height=\"8\" fill=\"#d9822b\"/></svg>",
      width(a_ms), width(b_ms));
}

std::string time_row(std::string_view name, double a_ms, double b_ms, double longest_ms, std::string_view kind = "") {
  return fmt::format(
      "<tr{}><td>{}</td><td class=\"n\">{:.3f}</td><td class=\"n\">{:.3f}</td><td "
      "class=\"n\">{}</td><td>{}</td></tr>\n",
      kind, escape_html(name), a_ms, b_ms, ratio_text(a_ms, b_ms), time_bars(a_ms, b_ms, longest_ms));
}

std::string times(const Comparison& c) {
  double longest = 0.0;
  double sum_a = 0.0;
  double sum_b = 0.0;
  double cpu_a = 0.0;
  double cpu_b = 0.0;
  for (const Run* run : {&c.a, &c.b})
    for (const StageTime& stage : run->stats.stages) {
      longest = std::max(longest, stage.gpu_ms);
      (run == &c.a ? sum_a : sum_b) += stage.gpu_ms;
      (run == &c.a ? cpu_a : cpu_b) += stage.cpu_ms;
    }
  std::string html = fmt::format(
      "<h2>Times</h2>\n<table><tr><th>GPU ms</th><th class=\"n\" style=\"color:var(--a)\">{0}</th><th class=\"n\" "
      "style=\"color:var(--b)\">{1}</th><th class=\"n\">ratio</th><th></th></tr>\n",
      side_name(c, false), side_name(c, true));
  for (const std::string& name : stage_names(c)) {
    const StageTime* const a = find_stage(c.a, name);
    const StageTime* const b = find_stage(c.b, name);
    html += time_row(name, a ? a->gpu_ms : 0.0, b ? b->gpu_ms : 0.0, longest);
  }
  const double whole = std::max({sum_a, sum_b, c.a.stats.frame_ms, c.b.stats.frame_ms});
  html += time_row("all stages", sum_a, sum_b, whole, " class=\"sum\"");
  html += time_row("CPU ms, all stages", cpu_a, cpu_b, whole);
  html += time_row("whole frame", c.a.stats.frame_ms, c.b.stats.frame_ms, whole, " class=\"sum\"");
  return html +
         fmt::format(
             "</table>\n<p class=\"about\">Medians of {} frames each, drawn in turns after warming up. Ratios are "
             "{} over {}. The last three rows have bars of their own scale.</p>\n",
             c.a.frames, side_name(c, true), side_name(c, false));
}

std::string text_row(std::string_view name, const std::string& a, const std::string& b, std::string_view cell) {
  return fmt::format("<tr><td>{}</td><td class=\"{}{}\">{}</td><td class=\"{}{}\">{}</td>", escape_html(name), cell,
                     a == b ? "" : " other", escape_html(a), cell, a == b ? "" : " other", escape_html(b));
}

std::string table_head(const Comparison& c, std::string_view cell) {
  return fmt::format("<table><tr><th></th><th class=\"{2}\">{0}</th><th class=\"{2}\">{1}</th>", side_name(c, false),
                     side_name(c, true), cell);
}

std::string counts(const Comparison& c) {
  std::string html = "<div><h2>Counters</h2>\n" + table_head(c, "n") + "<th class=\"n\">ratio</th></tr>\n";
  for (const Counter& counter : counters()) {
    const uint64_t a = c.a.stats.*counter.value;
    const uint64_t b = c.b.stats.*counter.value;
    const auto text = [&](uint64_t n) { return counter.is_bytes ? bytes_text(n) : with_separators(n); };
    html += text_row(counter.name, text(a), text(b), "n") +
            fmt::format("<td class=\"n\">{}</td></tr>\n", ratio_text(static_cast<double>(a), static_cast<double>(b)));
  }
  return html + "</table></div>\n";
}

std::string recipes(const Comparison& c) {
  std::string html = "<div><h2>Recipes</h2>\n" + table_head(c, "") + "</tr>\n";
  const nlohmann::ordered_json a = to_json(c.a)["recipe"];
  const nlohmann::ordered_json b = to_json(c.b)["recipe"];
  const auto plain = [](const nlohmann::ordered_json& v) { return v.is_string() ? v.get<std::string>() : v.dump(); };
  for (const auto& [stage, chosen] : a.items())
    if (stage != "settings") html += text_row(stage, plain(chosen), plain(b[stage]), "") + "</tr>\n";
  for (const auto& [setting, value] : a["settings"].items())
    html += text_row(setting, plain(value), plain(b["settings"][setting]), "") + "</tr>\n";
  return html + "</table></div>\n";
}

std::string camera_text(const NamedCamera& camera) {
  if (camera.chosen != ChosenView::asked)
    return fmt::format("chosen for a pack that has none ({})", name_of(camera.chosen));
  return camera.name.empty() ? "" : "“" + escape_html(camera.name) + "”";
}

std::string headlight_text(float headlight) {
  return headlight > 0.0f ? fmt::format(", headlight {:g}", headlight) : "";
}

std::string about(const Comparison& c) {
  const Camera& camera = c.a.camera.camera;
  const glm::dvec3 eye_m = in_file(camera, c.a.camera.origin_m).eye_m;
  return fmt::format(
      "<p class=\"about\">{}, {}×{} pixels, camera {} at ({:.2f}, {:.2f}, {:.2f}) looking along ({:.2f}, {:.2f}, "
      "{:.2f}), "
      "exposure {:+.2f} EV{} on both sides.<br>{}; {}</p>\n",
      escape_html(c.a.pack), c.a.settings.width, c.a.settings.height, camera_text(c.a.camera), eye_m.x, eye_m.y,
      eye_m.z, camera.forward_ws.x, camera.forward_ws.y, camera.forward_ws.z, c.a.stats.exposure_ev,
      headlight_text(c.a.settings.headlight), escape_html(c.a.device), escape_html(c.a.driver));
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string safe;
  for (const char c : text) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  return safe;
}

std::string report_html(const Comparison& c) {
  const std::string title =
      fmt::format("{} and {}: {}", side_name(c, false), side_name(c, true), escape_html(c.a.pack));
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">";
  html += fmt::format("<title>{}</title><style>{}</style></head>\n<body>\n<h1>{}</h1>\n", title, page_style, title);
  html += about(c) + pictures(c) + difference(c) + times(c);
  html += "<div class=\"columns\">\n" + counts(c) + recipes(c) + "</div>\n";
  html += fmt::format("<script>{}</script>\n</body>\n</html>\n", page_script);
  return html;
}

}  // namespace chandelier::player
