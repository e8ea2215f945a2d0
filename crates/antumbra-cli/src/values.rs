//! Values on the command line that clap does not know: points and angles.

use std::str::FromStr;

/// A point in scene units, written `x,y,z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointArg(pub [f64; 3]);

impl FromStr for PointArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|c| c.is_finite());
        let numbers: Vec<f64> = text.split(',').map_while(number).collect();
        match <[f64; 3]>::try_from(numbers) {
            Ok(point) if text.split(',').count() == 3 => Ok(Self(point)),
            _ => Err("expected three numbers like 1.5,-2,0".to_owned()),
        }
    }
}

/// An angle, kept in radians: `0.1mrad`, `0.01deg`, `1e-4rad`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AngleArg(pub f64);

impl FromStr for AngleArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || "expected an angle with its unit like 0.1mrad, 0.01deg or 1e-4rad".to_owned();
        let text = text.trim();
        let (number, unit) = [
            ("mrad", 1e-3),
            ("urad", 1e-6),
            ("rad", 1.0),
            ("deg", 1_f64.to_radians()),
        ]
        .into_iter()
        .find_map(|(name, unit)| Some((text.strip_suffix(name)?, unit)))
        .ok_or_else(wrong)?;
        let value = number.trim().parse::<f64>().map_err(|_| wrong())? * unit;
        if !(0.0..std::f64::consts::FRAC_PI_2).contains(&value) {
            return Err("expected an angle of at least 0 and less than 90 degrees".to_owned());
        }
        Ok(Self(value))
    }
}

/// A positive finite number, such as a length or an area.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("expected a positive number".to_owned()),
    }
}

/// The full angle of a view, in degrees.
pub(crate) fn view_angle(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if (0.01..=179.0).contains(&value) => Ok(value),
        _ => Err("expected an angle from 0.01 to 179 degrees".to_owned()),
    }
}

/// A crease angle, in degrees.
pub(crate) fn crease_angle(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=180.0).contains(&value) => Ok(value),
        _ => Err("expected an angle from 0 to 180 degrees".to_owned()),
    }
}

/// A size in pixels, written `WxH`.
pub(crate) fn pixels(text: &str) -> Result<[usize; 2], String> {
    let wrong = || "expected width and height like 1600x1000, each from 16 to 8192".to_owned();
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |s: &str| {
        s.trim()
            .parse()
            .ok()
            .filter(|n| (16..=8192).contains(n))
            .ok_or_else(wrong)
    };
    Ok([side(w)?, side(h)?])
}

#[cfg(test)]
mod tests {
    use super::{AngleArg, PointArg, crease_angle, pixels, positive, view_angle};

    #[test]
    fn points() {
        assert_eq!("-1,2.5, 3e2".parse(), Ok(PointArg([-1.0, 2.5, 300.0])));
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "1,2,inf", "1,,2"] {
            assert!(bad.parse::<PointArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn angles() {
        assert_eq!("0.1mrad".parse(), Ok(AngleArg(0.1e-3)));
        assert_eq!("1e-4rad".parse(), Ok(AngleArg(1e-4)));
        assert_eq!("180e-3deg".parse(), Ok(AngleArg(0.18 * 1_f64.to_radians())));
        for bad in ["0.1", "mrad", "-1deg", "90deg", "nanrad", "1 grad"] {
            assert!(bad.parse::<AngleArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_and_sizes() {
        assert_eq!(positive("2e-3"), Ok(0.002));
        assert!(positive("0").is_err() && positive("nan").is_err() && positive("x").is_err());
        assert_eq!((view_angle("60"), crease_angle("0")), (Ok(60.0), Ok(0.0)));
        assert!(view_angle("0").is_err() && view_angle("180").is_err());
        assert!(view_angle("nan").is_err() && crease_angle("-1").is_err());
        assert_eq!(pixels("640x480"), Ok([640, 480]));
        assert!(pixels("640").is_err() && pixels("0x3").is_err() && pixels("99999x9").is_err());
    }
}
