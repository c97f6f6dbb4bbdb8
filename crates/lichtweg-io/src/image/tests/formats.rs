//! Every format that is read, whole and damaged.

use std::io::{Cursor, Write};

use exr::prelude as ex;
use exr::prelude::WritableImage;
use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use image::{DynamicImage, ImageFormat};
use lichtweg::scene::description::Pixels;
use proptest::prelude::*;

use super::{assert_valid, numbers, shared};
use crate::image::{LoadedImage, parse_image, pfm, read_image};
use crate::mesh::fuzz::{SplitMix, feed_damaged, truncations};

const WIDTH: u32 = 5;
const HEIGHT: u32 = 3;

fn load(bytes: &[u8], extension: Option<&str>) -> LoadedImage {
    let loaded = parse_image(bytes, extension).unwrap();
    assert_valid(&loaded);
    assert_eq!((loaded.image.width, loaded.image.height), (WIDTH, HEIGHT));
    loaded
}

fn random_bytes(count: usize) -> Vec<u8> {
    let mut random = SplitMix(7);
    (0..count).map(|_| random.next() as u8).collect()
}

/// Random pixels in each of the colour types, encoded.
fn encoded(format: ImageFormat, channels: usize, bits: usize) -> (Vec<u8>, Vec<f32>) {
    let bytes = random_bytes(WIDTH as usize * HEIGHT as usize * channels * 2);
    let narrow = bytes[..bytes.len() / 2].to_vec();
    let wide: Vec<u16> = bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
    macro_rules! image {
        ($variant:ident, $data:expr) => {
            DynamicImage::$variant(image::ImageBuffer::from_raw(WIDTH, HEIGHT, $data).unwrap())
        };
    }
    let expected = match bits {
        8 => narrow.iter().map(|&x| f32::from(x)).collect(),
        _ => wide.iter().map(|&x| f32::from(x)).collect(),
    };
    let image = match (channels, bits) {
        (1, 8) => image!(ImageLuma8, narrow),
        (2, 8) => image!(ImageLumaA8, narrow),
        (3, 8) => image!(ImageRgb8, narrow),
        (4, 8) => image!(ImageRgba8, narrow),
        (1, _) => image!(ImageLuma16, wide),
        (2, _) => image!(ImageLumaA16, wide),
        (3, _) => image!(ImageRgb16, wide),
        _ => image!(ImageRgba16, wide),
    };
    let mut file = Cursor::new(Vec::new());
    image.write_to(&mut file, format).unwrap();
    (file.into_inner(), expected)
}

#[test]
fn png_of_every_colour_type() {
    for channels in 1..=4 {
        for bits in [8, 16] {
            let (bytes, expected) = encoded(ImageFormat::Png, channels, bits);
            let loaded = load(&bytes, None);
            assert_eq!(numbers(&loaded.image), expected, "{channels} channels of {bits} bits");
            assert_eq!(loaded.image.channels as usize, channels);
            assert_eq!(matches!(loaded.image.pixels, Pixels::U16(_)), bits == 16);
            assert!(loaded.image.srgb);
        }
    }
}

/// The kind and the body of a part of a PNG.
type Chunk<'a> = (&'a [u8; 4], &'a [u8]);

/// A PNG put together from its chunks; `rows` has one filter byte in front of each row.
fn png(bits: u8, color_type: u8, chunks: &[Chunk], rows: &[u8]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut push = |kind: &[u8; 4], body: &[u8]| {
        let mut checksum = Crc::new();
        checksum.update(kind);
        checksum.update(body);
        file.extend((body.len() as u32).to_be_bytes());
        file.extend(kind);
        file.extend(body);
        file.extend(checksum.sum().to_be_bytes());
    };
    let mut header = [WIDTH.to_be_bytes(), HEIGHT.to_be_bytes()].concat();
    header.extend([bits, color_type, 0, 0, 0]);
    push(b"IHDR", &header);
    chunks.iter().for_each(|(kind, body)| push(kind, body));
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(rows).unwrap();
    push(b"IDAT", &encoder.finish().unwrap());
    push(b"IEND", &[]);
    file
}

#[test]
fn png_palettes_and_single_bits_are_expanded() {
    let palette: &[u8] = &[10, 20, 30, 40, 50, 60];
    let rows = [0, 0b1010_0000].repeat(HEIGHT as usize);
    let loaded = load(&png(1, 3, &[(b"PLTE", palette)], &rows), None);
    assert_eq!(
        (loaded.image.channels, &numbers(&loaded.image)[..6]),
        (3, &[40., 50., 60., 10., 20., 30.][..])
    );
    let loaded = load(&png(1, 3, &[(b"PLTE", palette), (b"tRNS", &[128])], &rows), None);
    assert_eq!((loaded.image.channels, &numbers(&loaded.image)[4..8]), (4, &[10., 20., 30., 128.][..]));
    let loaded = load(&png(1, 0, &[], &rows), None);
    assert_eq!((loaded.image.channels, &numbers(&loaded.image)[..3]), (1, &[255., 0., 255.][..]));
}

#[test]
fn png_chunks_decide_about_the_curve() {
    let rows = [0_u8; (WIDTH as usize + 1) * HEIGHT as usize];
    let gamma = |value: u32| value.to_be_bytes();
    let (linear, srgb, other) = (gamma(100_000), gamma(45_455), gamma(55_556));
    let cases: [(&[Chunk], bool, usize); 6] = [
        (&[], true, 0),
        (&[(b"gAMA", &linear)], false, 0),
        (&[(b"gAMA", &srgb)], true, 0),
        (&[(b"gAMA", &other)], true, 1),
        (&[(b"gAMA", &linear), (b"sRGB", &[0])], true, 0),
        (&[(b"cICP", &[1, 8, 0, 1])], false, 0),
    ];
    for (chunks, is_srgb, warnings) in cases {
        let loaded = load(&png(8, 0, chunks, &rows), None);
        assert_eq!((loaded.image.srgb, loaded.warnings.len()), (is_srgb, warnings), "{chunks:?}");
    }
}

#[test]
fn tga_of_every_colour_type() {
    for channels in [1, 3, 4] {
        let (bytes, expected) = encoded(ImageFormat::Tga, channels, 8);
        let loaded = load(&bytes, Some("TGA"));
        assert_eq!(numbers(&loaded.image), expected, "{channels} channels");
        assert!(loaded.image.srgb);
        assert!(parse_image(&bytes[..bytes.len() - 1], None).is_err(), "needs its extension");
    }
}

/// Uncompressed, 24 bits, rows from the bottom up: how most programs write it.
#[test]
fn tga_from_the_bottom_up() {
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, WIDTH as u8, 0, HEIGHT as u8, 0, 24, 0];
    for row in (0..HEIGHT as u8).rev() {
        (0..WIDTH as u8).for_each(|column| bytes.extend([3, row, column]));
    }
    let loaded = load(&bytes, Some("tga"));
    assert_eq!(numbers(&loaded.image)[..6], [0.0, 0.0, 3.0, 1.0, 0.0, 3.0]);
}

#[test]
fn jpeg_is_close() {
    let grey =
        DynamicImage::ImageRgb8(image::RgbImage::from_pixel(WIDTH, HEIGHT, image::Rgb([200, 100, 50])));
    let mut file = Cursor::new(Vec::new());
    grey.write_to(&mut file, ImageFormat::Jpeg).unwrap();
    // The extension lies; the contents count.
    let loaded = load(&file.into_inner(), Some("tga"));
    assert!(loaded.image.srgb && loaded.image.channels == 3);
    for pixel in numbers(&loaded.image).chunks(3) {
        assert!(pixel.iter().zip([200.0, 100.0, 50.0]).all(|(a, b)| (a - b).abs() < 12.0), "{pixel:?}");
    }
}

/// Radiance's own example of the encoding: value = mantissa / 256 * 2^(exponent - 128).
#[test]
fn hdr_without_run_lengths() {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 5\n".to_vec();
    bytes.extend([128, 64, 32, 129].repeat((WIDTH * HEIGHT) as usize));
    let loaded = load(&bytes, None);
    assert_eq!(numbers(&loaded.image)[..3], [1.0, 0.5, 0.25]);
    assert!(!loaded.image.srgb);
}

#[test]
fn pfm_of_both_byte_orders_and_colours() {
    for (kind, channels) in [("PF", 3), ("Pf", 1)] {
        for (scale, factor) in [("-1.0", 1.0), ("1", 1.0), ("-2.5", 2.5), ("0.5", 0.5)] {
            for line_end in ["\n", " ", "\r\n"] {
                let mut bytes =
                    format!("{kind}{line_end}{WIDTH} {HEIGHT}{line_end}{scale}{line_end}").into_bytes();
                for row in (0..HEIGHT).rev() {
                    for i in 0..WIDTH * channels {
                        let number = (row * 100 + i) as f32;
                        bytes.extend(if scale.starts_with('-') {
                            number.to_le_bytes()
                        } else {
                            number.to_be_bytes()
                        });
                    }
                }
                let loaded = load(&bytes, None);
                let rows = (0..HEIGHT).flat_map(|row| (0..WIDTH * channels).map(move |i| row * 100 + i));
                let expected: Vec<f32> = rows.map(|number| number as f32 * factor).collect();
                assert_eq!(numbers(&loaded.image), expected, "{kind} {scale}");
                assert_eq!((loaded.image.channels, loaded.image.srgb), (channels, false));
                assert!(parse_image(&bytes[..bytes.len() - 1], None).is_err());
            }
        }
    }
}

#[test]
fn damaged_pfm_headers_are_explained() {
    for (header, part) in [
        ("PF\n5 3\n", "incomplete"),
        ("PF\n5 3\n-1", "incomplete"),
        ("PFM\n5 3\n-1\n", "incomplete"),
        ("PF\n-5 3\n-1\n", "\"-5\" for its width"),
        ("PF\n5 x\n-1\n", "\"x\" for its height"),
        ("PF\n5 3\n0\n", "\"0\" for its scale"),
        ("PF\n5 3\nnan\n", "\"nan\" for its scale"),
        ("PF\n0 3\n-1\n", "no pixels"),
        ("PF\n99999 99999\n-1\n", "119997600012 bytes"),
        ("PF\n18446744073709551615 18446744073709551615\n-1\n", "would take"),
        ("PF\n5 3\n-1\n", "ends after 0 of 180 bytes"),
    ] {
        let error = parse_image(header.as_bytes(), None).unwrap_err();
        assert!(error.message.contains(part), "{header:?}: {error}");
    }
}

#[test]
fn non_finite_numbers_become_zero_with_a_warning() {
    let mut numbers_in = vec![1.0; 45];
    numbers_in[17] = f32::NAN;
    numbers_in[20] = f32::NEG_INFINITY;
    let loaded = load(&pfm::write(5, 3, 3, &numbers_in), None);
    let numbers_out = numbers(&loaded.image);
    assert_eq!((numbers_out[16], numbers_out[17], numbers_out[20]), (1.0, 0.0, 0.0));
    assert_eq!(
        loaded.warnings,
        ["2 of 45 numbers are NaN or infinite, first in column 0 of row 1 (from 0, top left); 0 is used"]
    );
}

fn exr_file(channels: Vec<(&str, ex::FlatSamples)>, encoding: ex::Encoding) -> Vec<u8> {
    let list = channels.into_iter().map(|(name, samples)| ex::AnyChannel::new(name, samples)).collect();
    let size = (WIDTH as usize, HEIGHT as usize);
    let image = ex::Image::from_encoded_channels(size, encoding, ex::AnyChannels::sort(list));
    let mut file = Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).unwrap();
    file.into_inner()
}

fn plane(offset: f32) -> ex::FlatSamples {
    ex::FlatSamples::F32((0..15).map(|i| i as f32 + offset).collect())
}

fn exr_encodings() -> Vec<ex::Encoding> {
    let compressions = [
        ex::Compression::Uncompressed,
        ex::Compression::RLE,
        ex::Compression::ZIP1,
        ex::Compression::ZIP16,
        ex::Compression::PIZ,
    ];
    let blocks = [ex::Blocks::ScanLines, ex::Blocks::Tiles(ex::Vec2(2, 2))];
    let both = |compression| {
        blocks.map(|blocks| ex::Encoding { compression, blocks, line_order: ex::LineOrder::Increasing })
    };
    compressions.into_iter().flat_map(both).collect()
}

#[test]
fn exr_of_every_lossless_encoding() {
    for encoding in exr_encodings() {
        let loaded =
            load(&exr_file(vec![("R", plane(0.0)), ("G", plane(20.0)), ("B", plane(40.0))], encoding), None);
        assert_eq!(numbers(&loaded.image)[..6], [0.0, 20.0, 40.0, 1.0, 21.0, 41.0], "{encoding:?}");
        assert_eq!((loaded.image.channels, loaded.image.srgb), (3, false));
    }
}

#[test]
fn exr_of_every_number_type() {
    let half = ex::FlatSamples::F16((0..15).map(|i| ex::f16::from_f32(i as f32)).collect());
    let integer = ex::FlatSamples::U32((0..15).map(|i| i * 2).collect());
    let bytes = exr_file(vec![("R", half), ("G", integer), ("B", plane(0.5))], ex::Encoding::default());
    assert_eq!(numbers(&load(&bytes, None).image)[3..6], [1.0, 2.0, 1.5]);
}

#[test]
fn exr_colours_are_found_by_their_names() {
    let cases: [(&[&str], &[f32], usize); 6] = [
        (&["A", "B", "G", "R", "variance.R"], &[30.0, 20.0, 10.0, 0.0], 0),
        (&["Y"], &[0.0], 0),
        (&["A", "Y"], &[10.0, 0.0], 0),
        (&["Z", "diffuse.B", "diffuse.G", "diffuse.R"], &[30.0, 20.0, 10.0], 0),
        (&["normal.X", "sky.Y"], &[10.0], 0),
        (&["depth.Z"], &[0.0], 1),
    ];
    for (names, first_pixel, warnings) in cases {
        let channels = names.iter().enumerate().map(|(i, name)| (*name, plane(10.0 * i as f32))).collect();
        let loaded = load(&exr_file(channels, ex::Encoding::default()), None);
        assert_eq!(&numbers(&loaded.image)[..first_pixel.len()], first_pixel, "{names:?}");
        assert_eq!(
            (loaded.image.channels as usize, loaded.warnings.len()),
            (first_pixel.len(), warnings),
            "{names:?}"
        );
    }
}

#[test]
fn other_files_are_named() {
    for (bytes, part) in [
        (&b""[..], "empty"),
        (b"GIF89a", "GIF"),
        (b"II*\0", "TIFF"),
        (b"<html>", "HTML"),
        (b"hello", "no known image format"),
    ] {
        let error = parse_image(bytes, Some("png")).unwrap_err();
        assert!(error.message.contains(part) && error.help.contains("OpenEXR"), "{error}");
    }
    let error = read_image("no/such/Image.png".as_ref()).unwrap_err();
    assert!(error.to_string().starts_with("no/such/Image.png: cannot be read"), "{error}");
    assert_eq!(error.diagnostic().code, "bad-image");
}

/// Headers that ask for more memory than any image, or for more pixels than the file can hold.
#[test]
fn absurd_sizes_are_refused() {
    let mut header = encoded(ImageFormat::Png, 3, 8).0;
    let mut checksum = Crc::new();
    header[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    checksum.update(&header[12..29]);
    header[29..33].copy_from_slice(&checksum.sum().to_be_bytes());
    assert!(parse_image(&header, None).is_err());

    let mut tga = encoded(ImageFormat::Tga, 3, 8).0;
    tga[12..16].copy_from_slice(&[0xff; 4]);
    assert!(parse_image(&tga, Some("tga")).unwrap_err().message.contains("65535 x 65535"));
    tga[12..16].copy_from_slice(&[0xff, 0x3f, 0xff, 0x3f]);
    assert!(parse_image(&tga, Some("tga")).unwrap_err().message.contains("the file has only"));

    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000000000 +X 4000000000\n";
    assert!(parse_image(hdr, None).unwrap_err().message.contains("4000000000"));
}

/// One small valid file of each format, with its extension.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let mut jpeg = Cursor::new(Vec::new());
    DynamicImage::ImageRgb8(image::RgbImage::from_raw(WIDTH, HEIGHT, random_bytes(45)).unwrap())
        .write_to(&mut jpeg, ImageFormat::Jpeg)
        .unwrap();
    let mut hdr = Vec::new();
    let pixels: Vec<_> = (0..16 * 3).map(|i| image::Rgb([i as f32, 1.0, 0.5])).collect();
    image::codecs::hdr::HdrEncoder::new(&mut hdr).encode(&pixels, 16, 3).unwrap();
    vec![
        ("png", encoded(ImageFormat::Png, 3, 8).0),
        ("png", encoded(ImageFormat::Png, 1, 16).0),
        ("jpg", jpeg.into_inner()),
        ("tga", encoded(ImageFormat::Tga, 4, 8).0),
        ("hdr", hdr),
        ("pfm", pfm::write(5, 3, 3, &[0.5; 45])),
    ]
}

fn exr_samples() -> Vec<Vec<u8>> {
    let channels = || vec![("R", plane(0.0)), ("G", plane(20.0)), ("B", plane(40.0))];
    exr_encodings().into_iter().map(|encoding| exr_file(channels(), encoding)).collect()
}

#[test]
fn truncated_files_are_errors_or_valid() {
    let exr = exr_samples().into_iter().map(|bytes| ("exr", bytes));
    for (extension, bytes) in samples().into_iter().chain(exr) {
        let mut errors = 0;
        for prefix in truncations(&bytes) {
            match parse_image(prefix, Some(extension)) {
                // Some trailers can be done without, and JPEG decoders make do with half an image.
                Ok(loaded) => assert_valid(&loaded),
                Err(error) => {
                    errors += 1;
                    assert!(!error.help.is_empty());
                }
            }
        }
        assert!(errors > bytes.len() / 2, "{extension}: {errors} errors in {} bytes", bytes.len());
    }
}

fn feed(files: Vec<Vec<u8>>, extension: &str) {
    feed_damaged(&files, |bytes| {
        if let Ok(loaded) = parse_image(bytes, Some(extension)) {
            assert_valid(&loaded);
        }
    });
}

#[test]
fn damaged_integer_images_never_panic() {
    for extension in ["png", "jpg", "tga"] {
        feed(
            samples().into_iter().filter(|(kind, _)| *kind == extension).map(|(_, bytes)| bytes).collect(),
            extension,
        );
    }
}

#[test]
fn damaged_float_images_never_panic() {
    for extension in ["hdr", "pfm"] {
        feed(
            samples().into_iter().filter(|(kind, _)| *kind == extension).map(|(_, bytes)| bytes).collect(),
            extension,
        );
    }
}

#[test]
fn damaged_exr_images_never_panic() {
    feed(exr_samples(), "exr");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pfm_comes_back(width in 1..20_usize, height in 1..20_usize, grey in any::<bool>(), seed in any::<u64>()) {
        let channels = if grey { 1 } else { 3 };
        let mut random = SplitMix(seed);
        let numbers_in: Vec<f32> = (0..width * height * channels)
            .map(|_| Some(f32::from_bits(random.next() as u32)).filter(|x| x.is_finite()).unwrap_or(0.0))
            .collect();
        let loaded = parse_image(&pfm::write(width, height, channels, &numbers_in), None).unwrap();
        prop_assert_eq!((loaded.image.width as usize, loaded.image.height as usize), (width, height));
        prop_assert_eq!(numbers(&loaded.image), numbers_in);
    }
}

/// The textures of the test scenes, where those are at hand.
#[test]
fn scene_textures_load() {
    for (path, size, channels, srgb) in [
        ("scenes/veach-ajar/textures/landscape-with-a-lake.jpg", (1920, 1280), 3, true),
        ("scenes/veach-ajar/textures/Good Textures_005844.jpg", (2000, 3008), 3, true),
        ("scenes/house/textures/Tiles.tga", (1024, 1024), 3, true),
        ("scenes/house/textures/Skydome.pfm", (512, 512), 3, false),
    ] {
        let Some(path) = shared(path) else { continue };
        let loaded = read_image(&path).unwrap();
        assert_valid(&loaded);
        assert_eq!((loaded.image.width, loaded.image.height), size);
        assert_eq!((loaded.image.channels, loaded.image.srgb, loaded.warnings.len()), (channels, srgb, 0));
    }
}
