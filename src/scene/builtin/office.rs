pub(super) fn build() -> crate::scene::Scene { crate::scene::Scene::new("office") }
