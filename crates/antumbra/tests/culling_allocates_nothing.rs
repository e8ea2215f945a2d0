//! A frame allocates nothing, not even the first one: counted by the allocator, in a binary of its own.

use antumbra::cull::{
    Camera, Coherence, CullOptions, Culler, LeafTest, Method, Probability, Selection,
};
use antumbra::scene::synth::{MazeParams, maze};
use antumbra::scene::{ObjectId, SceneBuilder};

#[test]
fn no_frame_allocates() {
    let input = maze(&MazeParams {
        rooms: 6,
        furniture: 6,
        seed: 4,
    });
    let (scene, _) = SceneBuilder::new(input).build().expect("a scene");
    let coherence = Coherence {
        updating: true,
        skip: Some(Probability::SelfTuned),
        propagation: Some(Probability::SelfTuned),
        reuse_tree: true,
    };
    let variants = [
        CullOptions::default(),
        CullOptions::tight(),
        CullOptions::paper(Method::Standard, 32),
        CullOptions::paper(Method::Modified(LeafTest::Exact), 32),
        CullOptions::paper(Method::Inner, 32),
        CullOptions {
            selection: Selection::Region {
                occluders: 64,
                sweep: true,
            },
            doors: vec![ObjectId(2)],
            ..CullOptions::default()
        },
        CullOptions {
            coherence,
            ..CullOptions::default()
        },
    ];
    for options in variants {
        let mut culler = Culler::with_options(&scene, options.clone());
        let mut seen = 0;
        let counts = allocation_counter::measure(|| {
            for i in 0..300 {
                let t = f64::from(i) * 0.1;
                let camera = Camera::new(
                    [2.0 + t, 3.0 + (t * 0.7).sin(), 1.6],
                    [t.cos(), t.sin(), 0.0],
                    [0.0, 0.0, 1.0],
                    60.0,
                    1.7,
                );
                if let Ok(camera) = camera {
                    seen += culler.cull(&camera).objects().len();
                    seen += usize::from(culler.may_see_box([t, t, 0.0], [t + 1.0, t + 1.0, 1.0]));
                }
            }
        });
        assert!(seen > 300, "{options:?}");
        assert_eq!(counts.count_total, 0, "{counts:?} with {options:?}");
    }
}
