//! Questions of the main world, and answers of the render world.

use std::{
    mem,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use bevy_ecs::prelude::*;
use bevy_math::Vec2;
use bevy_picking::backend::ray::RayId;

use super::view::VisiblePoint;

/// Question for the visible point at a place of the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Question {
    /// Pointer and camera.
    pub ray: RayId,
    /// The pointer in the camera's viewport, in normalised device coordinates.
    pub ndc: Vec2,
    /// Counts the frames in which something was asked.
    pub frame: u64,
    /// Simulated time when it was asked \[s\].
    pub elapsed: f64,
}

/// The answer to a question, some frames later.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub question: Question,
    /// Visible point; `None` if nothing was drawn.
    pub point: Option<VisiblePoint>,
}

/// Shared by the two worlds and by the callbacks of the buffers that are read.
#[derive(Resource, Clone, Default)]
pub(super) struct Mailbox(Arc<Mutex<Mail>>);

#[derive(Default)]
struct Mail {
    questions: Vec<Question>,
    answers: Vec<Answer>,
}

impl Mailbox {
    /// Nothing is left half done where a holder of the lock panics, so that poisoning does not matter.
    fn mail(&self) -> MutexGuard<'_, Mail> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks in the frame that is rendered next, in place of everything that was not taken yet.
    pub fn ask(&self, questions: impl IntoIterator<Item = Question>) {
        let mut mail = self.mail();
        mail.questions.clear();
        mail.questions.extend(questions);
    }

    pub fn take_questions(&self) -> Vec<Question> {
        mem::take(&mut self.mail().questions)
    }

    pub fn answer(&self, answers: impl IntoIterator<Item = Answer>) {
        self.mail().answers.extend(answers);
    }

    pub fn take_answers(&self) -> Vec<Answer> {
        mem::take(&mut self.mail().answers)
    }
}
