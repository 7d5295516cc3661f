//! The lecture as a whole.

use raywood_scene::{Scene, builtin};

use super::*;

#[test]
fn judgements_by_conditions() {
    let judgement = Judgement::by_conditions;
    assert_eq!(judgement(&[true, true]), Judgement::Holds);
    assert_eq!(judgement(&[true, false]), Judgement::HoldsInPart);
    assert_eq!(judgement(&[false, false]), Judgement::Fails);
    assert_eq!(judgement(&[]), Judgement::NotMeasured);
}

#[test]
fn experiments_have_names_of_their_own() {
    for (number, entry) in EXPERIMENTS.iter().enumerate() {
        assert!(entry.id.bytes().all(|b| b.is_ascii_lowercase()), "{}", entry.id);
        assert!(EXPERIMENTS[..number].iter().all(|other| other.id != entry.id), "{}", entry.id);
    }
}

#[test]
fn an_empty_scene_is_refused() {
    let scenes = [Scene { name: "nothing".to_owned(), ..Scene::default() }];
    let refused = Lab::new(&scenes, true, 1).err();
    assert_eq!(refused, Some(LectureError::EmptyScene { scene: "nothing".to_owned() }));
}

#[test]
fn every_experiment_runs_on_a_scene_of_which_the_eye_sees_nothing() {
    let mut scene = builtin("sphereflake?depth=0").expect("a scene");
    for camera in &mut scene.cameras {
        // Up and away.
        camera.eye.y = 50.0;
        camera.target = camera.eye + raywood::Vec3::Y;
    }
    let scenes = [scene];
    let lab = Lab::new(&scenes, true, 1).expect("a scene");
    for entry in EXPERIMENTS {
        let experiment = entry.run(&lab).expect("it runs");
        for table in &experiment.tables {
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", entry.id);
        }
        assert!(!experiment.method.is_empty() && !experiment.verdict.explanation.is_empty());
    }
}
