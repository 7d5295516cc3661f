//! Light to picture files of every format, and back through readers that are not ours.

use std::io::{self, Cursor};
use std::path::Path;

use raywood_render::{
    Contents, IMAGE_FORMATS, Image, ImageFormat, Layer, RgbImage, TONE_MAPS, ToneMap, Values,
    WriteOptions, soft_clip, srgb8, write_png,
};
use raywood_scene::{Rgb, load_environment};

#[test]
fn colours_up_to_the_shoulder_stay_as_they_are() {
    for color in [Rgb::ZERO, Rgb::splat(0.18), Rgb::new(0.8, 0.1, 0.0), Rgb::splat(0.8)] {
        assert_eq!(soft_clip(color), color);
    }
    assert_eq!(srgb8(Rgb::ZERO), [0, 0, 0]);
    // Mid grey: linear 0.214 is sRGB 0.5.
    assert_eq!(srgb8(Rgb::splat(0.2140)), [127, 127, 127]);
    assert_eq!(srgb8(Rgb::splat(0.2159)), [128, 128, 128]);
}

#[test]
fn bright_colours_keep_their_hue_and_order_and_stay_below_white() {
    let mut last = 0.8;
    for step in 1..200 {
        let m = 0.8 + 0.01 * step as f32;
        let clipped = soft_clip(Rgb::new(m, 0.5 * m, 0.25 * m));
        assert!(clipped.x > last && clipped.x <= 1.0, "{m} becomes {clipped:?}");
        assert!((clipped.y / clipped.x - 0.5).abs() < 1e-6);
        assert!((clipped.z / clipped.x - 0.25).abs() < 1e-6);
        last = clipped.x;
    }
    // The slope goes on: just above the shoulder nothing jumps.
    assert!((soft_clip(Rgb::splat(0.81)).x - 0.81).abs() < 3e-4);
}

#[test]
fn extreme_light_becomes_a_colour_all_the_same() {
    for (light, shown) in [
        (Rgb::splat(f32::INFINITY), [255; 3]),
        (Rgb::new(f32::INFINITY, 1.0, 0.0), [255, 0, 0]),
        (Rgb::splat(f32::MAX), [255; 3]),
        (Rgb::splat(f32::NAN), [0; 3]),
        (Rgb::splat(-1.0), [0; 3]),
    ] {
        assert_eq!(srgb8(light), shown);
        assert_eq!(Image::from_pixels(1, 1, vec![light]).to_srgb8(), shown);
    }
}

/// Light of many brightnesses, a row of which has runs.
fn gradient(width: u32, height: u32) -> Image {
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let light = (0.7 * (x as f32 - 9.0)).exp2();
        if y == 2 { Rgb::splat(0.25) } else { Rgb::new(light, 0.5, 0.1 * y as f32) }
    };
    Image::from_pixels(width, height, (0..width * height).map(pixel).collect())
}

fn written(format: &ImageFormat, contents: Contents<'_>, options: &WriteOptions) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    format.write(contents, options, &mut bytes).expect("a file");
    bytes.into_inner()
}

fn format(name: &str) -> &'static ImageFormat {
    ImageFormat::of_path(Path::new(name)).expect("a format")
}

#[test]
fn a_png_holds_the_pixels_and_says_that_they_are_srgb() {
    let pixels: Vec<Rgb> = (0..35).map(|i| Rgb::new(i as f32 / 35.0, 0.5, 0.1)).collect();
    let image = Image::from_pixels(7, 5, pixels);
    let mut bytes = Vec::new();
    write_png(&image, &mut bytes).expect("a PNG");

    let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().expect("a PNG header");
    assert_eq!(reader.info().srgb, Some(png::SrgbRenderingIntent::Perceptual));
    let mut decoded = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut decoded).expect("pixels");
    assert_eq!((frame.width, frame.height), (7, 5));
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert_eq!(decoded, image.to_srgb8());
    assert_eq!(image.pixel(3, 4), image.row(4)[3]);
    // The same as by the registry, where nothing is asked for.
    let png = format("a.png");
    assert!(bytes == written(png, Contents::Computed(&image, &[]), &WriteOptions::of(png)));
}

#[test]
fn a_png_of_16_bits_tells_apart_what_8_do_not() {
    let image = Image::from_pixels(2, 1, vec![Rgb::splat(0.2), Rgb::splat(0.20005)]);
    let options = WriteOptions {
        bits: 16,
        metadata: vec![("Software".to_owned(), "Bäume".to_owned())],
        ..WriteOptions::of(format("a.png"))
    };
    let bytes = written(format("a.png"), Contents::Computed(&image, &[]), &options);
    let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().expect("a PNG header");
    let mut decoded = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut decoded).expect("pixels");
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgb, png::BitDepth::Sixteen));
    let text = &reader.info().utf8_text[0];
    assert_eq!((&*text.keyword, &*text.get_text().expect("a text")), ("Software", "Bäume"));

    let words: Vec<u16> = decoded.chunks(2).map(|w| u16::from_be_bytes([w[0], w[1]])).collect();
    // The formula of sRGB, in double precision.
    let encoded = |x: f64| (65_535.0 * (1.055 * x.powf(1.0 / 2.4) - 0.055)).round();
    for (word, light) in [(words[0], 0.2), (words[3], 0.20005)] {
        assert!((f64::from(word) - encoded(light)).abs() <= 1.0, "{light} becomes {word}");
    }
    assert!(words[0] < words[3]);
    assert_eq!(image.to_srgb8()[0], image.to_srgb8()[3]);
}

#[test]
fn numbers_and_drawings_are_written_as_they_are() {
    let numbers = Image::from_numbers(1, 1, vec![Rgb::new(0.5, 1.0, 0.0)]);
    let numbers = numbers.with_tone_map(&TONE_MAPS[3]);
    assert!(numbers.are_numbers());
    assert_eq!(numbers.to_srgb8(), [128, 255, 0]);

    let drawing = RgbImage::filled(3, 2, [1, 128, 255]);
    let options = WriteOptions { bits: 16, ..WriteOptions::of(format("a.png")) };
    let bytes = written(format("a.png"), Contents::Drawn(&drawing), &options);
    let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().expect("a PNG header");
    let mut decoded = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut decoded).expect("pixels");
    assert_eq!(decoded, [1, 1, 128, 128, 255, 255].repeat(6));
}

#[test]
fn tone_maps_are_seen_in_pictures_but_not_in_light() {
    let image = Image::from_pixels(1, 1, vec![Rgb::splat(1.0)]);
    let shown = |name: &str| {
        image.clone().with_tone_map(ToneMap::by_name(name).expect("a name")).to_srgb8()[0]
    };
    assert_eq!(shown("none"), 255);
    // 0.619 of the light.
    assert_eq!(shown("aces"), 206);
    let exr = format("a.exr");
    let light =
        |image: &Image| written(exr, Contents::Computed(image, &[]), &WriteOptions::of(exr));
    let mapped = image.clone().with_tone_map(&TONE_MAPS[3]);
    assert!(light(&image) == light(&mapped));
}

/// Writes light and reads it as a panorama.
fn light_of(name: &str, bits: u32, image: &Image) -> Vec<Rgb> {
    let format = format(name);
    let options = WriteOptions { bits, ..WriteOptions::of(format) };
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{bits}-{name}"));
    let bytes = written(format, Contents::Computed(image, &[]), &options);
    std::fs::write(&path, bytes).expect("a file");
    let sky = load_environment(&path).expect("a panorama");
    let (width, height) = (image.width(), image.height());
    assert_eq!((sky.width(), sky.height()), (width, height));
    // The middles of texels.
    let middle = |number: u32, count: u32| (number as f32 + 0.5) / count as f32;
    let texel = |i| sky.light(middle(i % width, width), middle(i / width, height));
    (0..width * height).map(texel).collect()
}

#[test]
fn light_survives_in_the_formats_that_hold_it() {
    for (width, height) in [(32, 4), (5, 3)] {
        let image = gradient(width, height);
        for (name, bits, relative) in
            [("light.exr", 32, 1e-5), ("light.exr", 16, 5e-4), ("light.hdr", 8, 0.5 / 128.0)]
        {
            for (read, pixel) in light_of(name, bits, &image).into_iter().zip(image.pixels()) {
                let error = (read - *pixel).abs().max_element();
                let largest = pixel.max_element();
                assert!(error <= relative * largest, "{name}, {bits}: {read:?} was {pixel:?}");
            }
        }
    }
}

#[test]
fn light_that_no_number_holds_is_written_as_the_next() {
    let extreme = vec![Rgb::splat(f32::MAX), Rgb::splat(f32::NAN), Rgb::new(-1.0, 1e-42, 1e30)];
    let image = Image::from_pixels(3, 1, extreme);
    let [bright, none, mixed] = light_of("extreme.hdr", 8, &image)[..] else { panic!("texels") };
    assert!(bright.x > 1e38 && none == Rgb::ZERO && (mixed.z / 1e30 - 1.0).abs() < 0.01);
    assert!(mixed.x < 1e28 && mixed.y < 1e28, "{mixed:?}");
    let [bright, ..] = light_of("extreme.exr", 16, &image)[..] else { panic!("texels") };
    assert_eq!(bright, Rgb::splat(65504.0));
}

#[test]
fn layers_lie_beside_the_picture_each_as_exact_as_it_needs() {
    use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};

    let image = gradient(4, 2);
    let layers = [
        Layer { name: "depth", channels: vec![("Z", Values::Exact(vec![1.0 / 3.0; 8]))] },
        Layer { name: "normal", channels: vec![("X", Values::Short(vec![0.5; 8]))] },
        Layer { name: "primitive", channels: vec![("id", Values::Whole((0..8).collect()))] },
    ];
    let exr = format("a.exr");
    let metadata = [("Software", "raywood"), ("raywood:command", "-o Bäume.exr")];
    let metadata = metadata.map(|(name, text)| (name.to_owned(), text.to_owned())).to_vec();
    let options = WriteOptions { metadata, ..WriteOptions::of(exr) };
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("layers.exr");
    let bytes = written(exr, Contents::Computed(&image, &layers), &options);
    std::fs::write(&path, bytes).expect("a file");

    let read = read_first_flat_layer_from_file(&path).expect("an EXR");
    let channels = &read.layer_data.channel_data.list;
    let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "depth.Z", "normal.X", "primitive.id"]);
    assert!(matches!(&channels[0].sample_data, FlatSamples::F16(values) if values.len() == 8));
    assert_eq!(channels[3].sample_data, FlatSamples::F32(vec![1.0 / 3.0; 8]));
    assert!(matches!(&channels[4].sample_data, FlatSamples::F16(_)));
    assert_eq!(channels[5].sample_data, FlatSamples::U32((0..8).collect()));
    let attributes = &read.layer_data.attributes;
    assert_eq!(attributes.software_name.as_ref().map(ToString::to_string), Some("raywood".into()));
    let comments = attributes.comments.as_ref().expect("comments");
    assert_eq!(comments.bytes(), "raywood:command: -o Bäume.exr".as_bytes());
}

#[test]
fn a_jpeg_is_close_and_closer_by_quality() {
    let shown = |i: u32| {
        let [x, y] = [i % 64, i / 64].map(|i| i as f32 / 64.0);
        Rgb::new(0.2 + 0.5 * x, 0.3 + 0.3 * y, 0.4)
    };
    let image = Image::from_pixels(64, 64, (0..64 * 64).map(shown).collect());
    let jpeg = format("a.JPG");
    let files = [10, 60, 95].map(|quality| {
        let options = WriteOptions { quality, ..WriteOptions::of(jpeg) };
        written(jpeg, Contents::Computed(&image, &[]), &options)
    });
    let errors = files.each_ref().map(|file| {
        let mut decoder = zune_jpeg::JpegDecoder::new(Cursor::new(file));
        let decoded = decoder.decode().expect("a JPEG");
        assert_eq!(decoder.dimensions(), Some((64, 64)));
        let off = decoded.iter().zip(image.to_srgb8()).map(|(a, b)| u32::from(a.abs_diff(b)));
        off.sum::<u32>() as f32 / decoded.len() as f32
    });
    assert!(files[0].len() < files[1].len() && files[1].len() < files[2].len());
    assert!(errors[0] > errors[1] && errors[2] < 1.0, "{errors:?}");
}

#[test]
fn what_a_format_cannot_hold_is_refused() {
    assert!(ImageFormat::of_path(Path::new("picture.bmp")).is_none());
    assert!(ImageFormat::of_path(Path::new("picture")).is_none());
    let image = gradient(2, 2);
    let drawing = RgbImage::filled(2, 2, [0; 3]);
    for format in &IMAGE_FORMATS {
        let mut out = Cursor::new(Vec::new());
        let mut options = WriteOptions { bits: 7, ..WriteOptions::of(format) };
        let error = format.write(Contents::Computed(&image, &[]), &options, &mut out);
        let said = error.expect_err("no such bits").to_string();
        assert!(said.contains("7 bits") && said.contains(format.name), "{said}");
        options.bits = format.bits[0];
        let drawn = format.write(Contents::Drawn(&drawing), &options, &mut out);
        assert_eq!(drawn.is_ok(), !format.holds_light, "{format}");
    }
    let wide = Image::from_pixels(70_000, 1, vec![Rgb::ONE; 70_000]);
    let jpeg = format("a.jpeg");
    let out = Cursor::new(Vec::new());
    let error = jpeg.write(Contents::Computed(&wide, &[]), &WriteOptions::of(jpeg), out);
    assert!(error.expect_err("too wide").to_string().contains("70000x1"));
}

#[test]
fn a_writer_that_fails_is_told_of() {
    struct Full;
    impl io::Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::Error::new(io::ErrorKind::StorageFull, "full"))
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    impl io::Seek for Full {
        fn seek(&mut self, _: io::SeekFrom) -> io::Result<u64> {
            Ok(0)
        }
    }
    let image = gradient(40, 3);
    for format in &IMAGE_FORMATS {
        let options = WriteOptions::of(format);
        let error = format.write(Contents::Computed(&image, &[]), &options, Full);
        let error = error.expect_err("a full disk");
        assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{format}: {error}");
    }
}
