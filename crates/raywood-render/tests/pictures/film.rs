//! Linear light to eight bits, and to a PNG that a reader understands.

use raywood_render::{Image, soft_clip, srgb8, write_png};
use raywood_scene::Rgb;

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
    assert_eq!(srgb8(Rgb::splat(f32::INFINITY)), [255; 3]);
    assert_eq!(srgb8(Rgb::new(f32::INFINITY, 1.0, 0.0)), [255, 0, 0]);
    assert_eq!(srgb8(Rgb::splat(f32::MAX)), [255; 3]);
    assert_eq!(srgb8(Rgb::splat(f32::NAN)), [0; 3]);
    assert_eq!(srgb8(Rgb::splat(-1.0)), [0; 3]);
}

#[test]
fn a_png_holds_the_pixels_and_says_that_they_are_srgb() {
    let pixels: Vec<Rgb> = (0..35).map(|i| Rgb::new(i as f32 / 35.0, 0.5, 0.1)).collect();
    let image = Image::from_pixels(7, 5, pixels);
    let mut bytes = Vec::new();
    write_png(&image, &mut bytes).expect("a PNG");

    let mut reader =
        png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("a PNG header");
    assert_eq!(reader.info().srgb, Some(png::SrgbRenderingIntent::Perceptual));
    let mut decoded = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut decoded).expect("pixels");
    assert_eq!((frame.width, frame.height), (7, 5));
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert_eq!(decoded, image.to_srgb8());
    assert_eq!(image.pixel(3, 4), image.row(4)[3]);
}

#[test]
fn a_writer_that_fails_is_told_of() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::new(std::io::ErrorKind::StorageFull, "full"))
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let image = Image::from_pixels(1, 1, vec![Rgb::ONE]);
    let error = write_png(&image, Full).expect_err("a full disk");
    assert_eq!(error.kind(), std::io::ErrorKind::StorageFull);
}
