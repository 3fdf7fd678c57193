//! Balls by touch as text.

use super::view::table;
use abbe::results::{BallCentre, TouchImport};
use abbe::text::{counted, significant};

pub(crate) fn text(result: &TouchImport) -> String {
    let poses = counted(result.centres.len(), "ball pose");
    let mut text =
        format!("{}: {}, {poses}, {} contacts\n", result.machine, counted(result.balls, "ball"), result.touches);
    text += &format!(
        "effective radius {:.4} mm, u {} um; a touch scatters by {} um over {} degrees of freedom\n",
        result.effective_radius_mm,
        significant(result.effective_radius_u_um, 2),
        significant(result.sigma_um, 3),
        significant(result.degrees_of_freedom, 4)
    );
    let lobing = &result.lobing;
    text += &match (lobing.is_determined, lobing.is_significant) {
        (false, _) => {
            "the touches do not tell a threefold lobing of the probe, which displaces every centre alike: it \
                       takes six touches around a ball, turned from ball to ball, or seven\n"
                .to_owned()
        }
        (true, false) => format!("no lobing of the probe beyond {} um\n", significant(3.7 * lobing.u_um, 2)),
        (true, true) => format!(
            "lobing of the probe {} um, u {} um, taken out of the centres\n",
            significant(lobing.amplitude_um, 3),
            significant(lobing.u_um, 2)
        ),
    };
    let mut rows = table(&["ball", "pose", "rotary deg", "x mm", "y mm", "z mm", "u um", "contacts"]);
    for centre in &result.centres {
        let _ = rows.add_row(row(centre));
    }
    text + &format!("{rows}\nu: standard uncertainty of each coordinate; `--format json` has the covariances\n")
}

fn row(centre: &BallCentre) -> [String; 8] {
    let rotary: Vec<String> = centre.rotary.iter().map(|(name, q)| format!("{name}{}", significant(*q, 6))).collect();
    let [x, y, z] = centre.centre_mm.map(|x| format!("{x:.4}"));
    let u = |k: usize| significant(centre.covariance_um2[k][k].max(0.0).sqrt(), 2);
    let us = [u(0), u(1), u(2)].join(" ");
    [centre.ball.clone(), centre.pose.clone(), rotary.join(" "), x, y, z, us, centre.touches.to_string()]
}
