//! Written images: what comes back, and what is left behind when writing fails.

use proptest::prelude::*;

use super::{Scratch, numbers, shared};
use crate::image::{ExrChannels, Layer, OutputImage, ToneMap, read_exr_layers, read_image, write_image};
use crate::mesh::fuzz::SplitMix;

fn layer(name: &str, channels: &[&str], data: Vec<f32>) -> Layer {
    Layer {
        name: name.to_owned(),
        channels: channels.iter().map(|&channel| channel.to_owned()).collect(),
        data,
    }
}

fn with_beauty(width: u32, height: u32, channels: &[&str], data: Vec<f32>) -> OutputImage {
    OutputImage { layers: vec![layer("", channels, data)], ..OutputImage::new(width, height) }
}

const RGB: [&str; 3] = ["R", "G", "B"];

/// Layers, metadata and the crop window of an EXR file come back, numbers bit for bit.
#[test]
fn exr_keeps_everything() {
    let scratch = Scratch::new("exr");
    let mut image = with_beauty(2, 1, &RGB, vec![1.0, 2.0, 3.0, 1e-30, f32::INFINITY, -6.0]);
    image.layers.push(layer("variance", &RGB, vec![0.1; 6]));
    image.layers.push(layer("normal", &["X", "Y", "Z"], vec![0.0, 0.0, 1.0, 0.0, 1.0, 0.0]));
    image.layers.push(layer("depth", &["Z"], vec![7.0, f32::NAN]));
    image.data_offset = [3, -4];
    image.display_size = [640, 480];
    let standard = ("version".to_owned(), "0.1".to_owned());
    image.metadata = vec![("samples per pixel".to_owned(), "64 ± 0".to_owned()), standard];
    image.metadata.push(("k".repeat(300), String::new()));
    image.metadata.push((String::new(), "nameless\0".to_owned()));
    let path = scratch.file("image.EXR");
    write_image(&path, &image, &ToneMap::default()).unwrap();

    let file = read_exr_layers(&path).unwrap();
    assert_eq!((file.width, file.height), (2, 1));
    assert_eq!((file.data_offset, file.display_size), ([3, -4], [640, 480]));
    let names: Vec<&str> = file.channels.iter().map(|(name, _)| name.as_str()).collect();
    let expected = "B G R depth.Z normal.X normal.Y normal.Z variance.B variance.G variance.R";
    assert_eq!(names, expected.split(' ').collect::<Vec<_>>());
    assert_eq!(file.channel("G").unwrap(), [2.0, f32::INFINITY]);
    assert_eq!(file.channel("normal.Y").unwrap(), [0.0, 1.0]);
    assert!(file.channel("depth.Z").unwrap()[1].is_nan());
    let value =
        |key: &str| file.metadata.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str());
    assert_eq!(value("samples per pixel"), Some("64 ± 0"));
    assert_eq!(value("lichtweg:version"), Some("0.1"));
    assert_eq!(value(&"k".repeat(255)), Some(""));
    assert_eq!(value("lichtweg:"), Some("nameless\0"));
    assert_eq!(scratch.names(), ["image.EXR"]);

    let colour = read_image(&path).unwrap();
    assert_eq!(numbers(&colour.image), [1.0, 2.0, 3.0, 1e-30, 0.0, -6.0]);
}

/// The numbers of IEC 61966-2-1, and the exposure in front of it.
#[test]
fn png_goes_through_the_srgb_curve() {
    let scratch = Scratch::new("png");
    let path = scratch.file("image.png");
    let data = vec![0.0, 0.001, 0.18, 0.5, 1.0, 2.0, -1.0, f32::NAN, f32::INFINITY];
    let image = with_beauty(3, 1, &RGB, data);
    write_image(&path, &image, &ToneMap::default()).unwrap();
    let loaded = read_image(&path).unwrap();
    assert!(loaded.image.srgb);
    assert_eq!(numbers(&loaded.image), [0.0, 3.0, 118.0, 188.0, 255.0, 255.0, 0.0, 0.0, 255.0]);
    write_image(&path, &image, &ToneMap { exposure_stops: -1.0 }).unwrap();
    assert_eq!(numbers(&read_image(&path).unwrap().image)[3..6], [137.0, 188.0, 255.0]);
}

#[test]
fn png_keeps_grey_and_linear_alpha() {
    let scratch = Scratch::new("alpha");
    let path = scratch.file("image.png");
    let cases: [(&[&str], &[f32], &[f32]); 3] = [
        (&["Y"], &[0.5], &[188.0]),
        (&["Y", "A"], &[0.5, 0.5], &[188.0, 128.0]),
        (&["R", "G", "B", "A"], &[0.5, 0.0, 1.0, 0.5], &[188.0, 0.0, 255.0, 128.0]),
    ];
    for (channels, data, expected) in cases {
        write_image(&path, &with_beauty(1, 1, channels, data.to_vec()), &ToneMap::default()).unwrap();
        let loaded = read_image(&path).unwrap();
        assert_eq!(
            (loaded.image.channels as usize, numbers(&loaded.image)),
            (channels.len(), expected.to_vec())
        );
    }
}

#[test]
fn jpeg_is_tone_mapped_and_drops_alpha() {
    let scratch = Scratch::new("jpeg");
    let linear = 0.5_f32.powf(2.2);
    for (channels, kept) in
        [(&["Y"][..], 1), (&["Y", "A"], 1), (&["R", "G", "B"], 3), (&["R", "G", "B", "A"], 3)]
    {
        let image = with_beauty(16, 16, channels, vec![linear; 256 * channels.len()]);
        let path = scratch.file("image.jpg");
        write_image(&path, &image, &ToneMap::default()).unwrap();
        let loaded = read_image(&path).unwrap();
        assert_eq!((loaded.image.width, loaded.image.channels), (16, kept));
        // Half of 255, within what the compression loses on an even colour.
        assert!(numbers(&loaded.image).iter().all(|n| (n - 127.5).abs() < 3.0), "{channels:?}");
    }
}

#[test]
fn float_formats_drop_alpha_and_other_layers() {
    let scratch = Scratch::new("alpha-float");
    let mut image = with_beauty(1, 2, &["R", "G", "B", "A"], vec![1.0, 2.0, 4.0, 0.5, 8.0, 16.0, 32.0, 0.5]);
    image.layers.insert(0, layer("depth", &["Z"], vec![9.0; 2]));
    for name in ["image.pfm", "image.hdr"] {
        let path = scratch.file(name);
        write_image(&path, &image, &ToneMap { exposure_stops: 3.0 }).unwrap();
        let loaded = read_image(&path).unwrap();
        assert_eq!((loaded.image.width, loaded.image.height, loaded.image.channels), (1, 2, 3));
        assert_eq!(numbers(&loaded.image), [1.0, 2.0, 4.0, 8.0, 16.0, 32.0], "{name}");
    }
    let grey = with_beauty(2, 1, &["Y"], vec![1.0, 2.0]);
    write_image(&scratch.file("grey.pfm"), &grey, &ToneMap::default()).unwrap();
    assert_eq!(read_image(&scratch.file("grey.pfm")).unwrap().image.channels, 1);
    write_image(&scratch.file("grey.hdr"), &grey, &ToneMap::default()).unwrap();
    let loaded = read_image(&scratch.file("grey.hdr")).unwrap();
    assert_eq!(numbers(&loaded.image), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
}

#[test]
fn hdr_clamps_what_it_cannot_hold() {
    let scratch = Scratch::new("hdr-clamp");
    let path = scratch.file("image.hdr");
    let data = vec![
        f32::NAN,
        -1.0,
        2.0,
        f32::INFINITY,
        f32::MAX,
        0.0,
        f32::MIN_POSITIVE,
        1e-40,
        0.0,
        1e-40,
        0.0,
        0.0,
    ];
    write_image(&path, &with_beauty(4, 1, &RGB, data), &ToneMap::default()).unwrap();
    let numbers = numbers(&read_image(&path).unwrap().image);
    assert_eq!(numbers[..3], [0.0, 0.0, 2.0]);
    assert!(numbers[3] > 1.6e38 && numbers[4] > 1.6e38 && numbers[5] == 0.0, "{numbers:?}");
    assert!(numbers[6..].iter().all(|&x| x < 1e-37), "{numbers:?}");
}

#[test]
fn failures_leave_nothing_behind() {
    let scratch = Scratch::new("failures");
    let image = with_beauty(1, 1, &RGB, vec![0.5; 3]);
    let tone_map = ToneMap::default();
    let error = write_image(&scratch.file("image.gif"), &image, &tone_map).unwrap_err();
    assert!(error.message.contains("`.gif`") && error.help.contains(".exr"), "{error}");
    let error = write_image(&scratch.file("image"), &image, &tone_map).unwrap_err();
    assert!(error.message.contains("(none)"), "{error}");
    let error = write_image(&scratch.file("missing/image.exr"), &image, &tone_map).unwrap_err();
    assert!(
        error.help.contains("make the directory") && error.help.contains("missing"),
        "{error}: {}",
        error.help
    );

    std::fs::create_dir(scratch.file("taken.png")).unwrap();
    let error = write_image(&scratch.file("taken.png"), &image, &tone_map).unwrap_err();
    assert!(error.message.contains("cannot be written"), "{error}");
    std::fs::write(scratch.file("file"), "").unwrap();
    let error = write_image(&scratch.file("file/image.png"), &image, &tone_map).unwrap_err();
    assert!(error.help.contains("is no directory"), "{error}: {}", error.help);

    // The encoder fails after the temporary file has been opened; what was there before stays.
    std::fs::write(scratch.file("old.png"), "old").unwrap();
    let no_beauty = OutputImage { layers: vec![layer("depth", &["Z"], vec![1.0])], ..OutputImage::new(1, 1) };
    let error = write_image(&scratch.file("old.png"), &no_beauty, &tone_map).unwrap_err();
    assert!(error.help.contains(".exr"), "{error}");
    assert_eq!(std::fs::read(scratch.file("old.png")).unwrap(), b"old");
    let mut names = scratch.names();
    names.sort();
    assert_eq!(names, ["file", "old.png", "taken.png"]);
}

#[test]
fn inconsistent_images_are_refused() {
    let scratch = Scratch::new("inconsistent");
    let mut twice = with_beauty(1, 1, &RGB, vec![0.0; 3]);
    twice.layers.push(layer("", &["R"], vec![0.0]));
    for image in [
        OutputImage::new(1, 1),
        with_beauty(0, 1, &RGB, Vec::new()),
        with_beauty(2, 1, &RGB, vec![0.0; 5]),
        with_beauty(1, 1, &[], Vec::new()),
        with_beauty(1, 1, &["R", "", "B"], vec![0.0; 3]),
        twice,
    ] {
        assert!(write_image(&scratch.file("image.exr"), &image, &ToneMap::default()).is_err(), "{image:?}");
    }
    assert!(scratch.names().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any numbers, NaN included, come back from EXR bit for bit.
    #[test]
    fn exr_comes_back(width in 1..40_u32, height in 1..40_u32, seed in any::<u64>()) {
        let scratch = Scratch::new("exr-property");
        let path = scratch.file("image.exr");
        let pixels = width as usize * height as usize;
        let mut random = SplitMix(seed);
        let mut data = |channels: usize| (0..pixels * channels).map(|_| f32::from_bits(random.next() as u32)).collect();
        let mut image = with_beauty(width, height, &RGB, data(3));
        image.layers.push(layer("depth", &["Z"], data(1)));
        write_image(&path, &image, &ToneMap::default()).unwrap();
        let file = read_exr_layers(&path).unwrap();
        let bits = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        for (index, name) in RGB.iter().enumerate() {
            let written: Vec<f32> = image.layers[0].data.iter().skip(index).step_by(3).copied().collect();
            prop_assert_eq!(bits(file.channel(name).unwrap()), bits(&written));
        }
        prop_assert_eq!(bits(file.channel("depth.Z").unwrap()), bits(&image.layers[1].data));
    }

    /// RGBE has 8 bits for the largest channel.
    #[test]
    fn hdr_comes_back_to_its_precision(width in 1..40_u32, height in 1..10_u32, seed in any::<u64>()) {
        let scratch = Scratch::new("hdr-property");
        let path = scratch.file("image.hdr");
        let mut random = SplitMix(seed);
        let mut number = || (random.below(1 << 20) as f32 / 65_536.0).exp2() * 1e-3;
        let data: Vec<f32> = (0..width * height * 3).map(|_| number()).collect();
        write_image(&path, &with_beauty(width, height, &RGB, data.clone()), &ToneMap::default()).unwrap();
        let loaded = read_image(&path).unwrap();
        prop_assert_eq!((loaded.image.width, loaded.image.height), (width, height));
        for (read, written) in numbers(&loaded.image).chunks(3).zip(data.chunks(3)) {
            let step = written.iter().fold(0.0_f32, |a, &b| a.max(b)) / 128.0;
            prop_assert!(read.iter().zip(written).all(|(a, b)| (a - b).abs() <= step), "{:?} {:?}", read, written);
        }
    }
}

/// The reference images, where those are at hand: beauty and variance of the same size.
#[test]
fn references_load() {
    for name in ["cornell-box", "house-spectral", "veach-ajar", "veach-bidir", "veach-mis"] {
        let Some(path) = shared(&format!("refs/{name}.exr")) else { continue };
        let file: ExrChannels = read_exr_layers(&path).unwrap();
        for channel in ["R", "G", "B", "variance.R", "variance.G", "variance.B"] {
            let numbers = file.channel(channel).unwrap();
            assert_eq!(numbers.len(), (file.width * file.height) as usize);
            assert!(numbers.iter().all(|x| x.is_finite()), "{name} {channel}");
        }
    }
}
