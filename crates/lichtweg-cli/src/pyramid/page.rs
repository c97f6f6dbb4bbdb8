//! The page to look at the strategies with: a grid of pictures, and one of them large, with its numbers.

use lichtweg::render::{Pyramid, StrategyImage};

use super::{file_name, gain, mean, share};

const HEAD: &str = "<!DOCTYPE html>
<html lang=\"en\"><meta charset=\"utf-8\"><title>Path pyramid</title>
<style>
body { background: #181818; color: #ccc; font: 14px sans-serif; margin: 1em; }
td { text-align: center; vertical-align: top; padding: 4px; }
td img { width: 128px; cursor: pointer; image-rendering: pixelated; display: block; }
#large { position: sticky; top: 0; background: #181818; padding-bottom: 1em; }
#large img { height: 60vh; image-rendering: pixelated; }
small { color: #888; }
</style>
<h1>Path pyramid</h1>
<p>Each row holds the paths of one length, in edges; s is the number of vertices made from the light, t of those made from the
eye. Pictures of longer paths are shown brighter by the factor written. Click one to enlarge it.
<label><input type=\"checkbox\" id=\"unweighted\"> without weights</label></p>
<div id=\"large\"></div>
";

const SCRIPT: &str = "<script>
let current = null;
const kind = () => document.getElementById('unweighted').checked ? 'unweighted' : 'weighted';
function refresh() {
  for (const img of document.querySelectorAll('td img')) img.src = img.dataset.name + '-' + kind() + '.png';
  if (current) {
    const large = document.getElementById('large');
    large.innerHTML = '<img alt=\"\" src=\"' + current.dataset.name + '-' + kind() + '.png\"><p></p>';
    large.lastChild.textContent = current.dataset.text;
  }
}
document.getElementById('unweighted').onchange = refresh;
for (const img of document.querySelectorAll('td img')) img.onclick = () => { current = img; refresh(); };
</script>
";

/// The page.
pub fn page(pyramid: &Pyramid, total: f64) -> String {
    let mut out = String::from(HEAD);
    let mut put = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    put(format!(
        "<p>{} samples per pixel, {:.1} seconds; mean radiance {total:.6}</p><table>",
        pyramid.samples_per_pixel, pyramid.seconds
    ));
    let longest = pyramid.strategies.iter().map(|i| i.s + i.t - 1).max().unwrap_or(0);
    for edges in 1..=longest {
        put(format!("<tr><th>length {edges}</th>"));
        for image in pyramid.strategies.iter().filter(|i| i.s + i.t == edges + 1) {
            put(cell(image, total));
        }
        put("</tr>".to_owned());
    }
    put("</table>".to_owned());
    out.push_str(SCRIPT);
    out
}

fn cell(image: &StrategyImage, total: f64) -> String {
    let (s, t, name) = (image.s, image.t, file_name(image));
    let (share, variance) = (share(image, total), mean(&image.variance));
    let unweighted = mean(&image.variance_unweighted);
    let gain = gain(image);
    let text = format!(
        "s = {s}, t = {t}: {share:.3} % of the image; mean {:.6} (unweighted {:.6}); variance of the mean {variance:.3e} \
         (unweighted {unweighted:.3e}); shown x {gain}",
        mean(&image.weighted),
        mean(&image.unweighted),
    );
    format!(
        "<td><img alt=\"s = {s}, t = {t}\" src=\"{name}-weighted.png\" data-name=\"{name}\" data-text=\"{text}\">\
         s = {s}, t = {t}<br><small>{share:.2} %, var {variance:.1e}</small></td>"
    )
}
